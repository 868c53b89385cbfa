// BVH text: what is read is complete, can be written, and reads back as the same.
#include <motiongan/formats/bvh.hpp>
#include <motiongan/formats/read_motion.hpp>

#include "../memory_folder.hpp"
#include "../target.hpp"

namespace motiongan::fuzz {

const Target bvh_target{"bvh", [](std::string_view bytes) {
                          const motion::Clip clip = motion::parse_bvh(bytes, "input.bvh");
                          demand(clip.channels.size() == clip.frames * clip.skeleton.channel_count(),
                                 "a clip holds all channels of all frames");
                          const std::string text =
                              must("a clip can be written", [&] { return motion::format_bvh(clip); });
                          const motion::Clip again = must("a written clip can be read",
                                                          [&] { return motion::parse_bvh(text, "again"); });
                          demand(again.skeleton == clip.skeleton && again.channels == clip.channels &&
                                     again.frame_time == clip.frame_time,
                                 "a written clip reads back as the same");
                          motion::read_motion(memory_folder().write("input.bvh", bytes));
                        }};

}  // namespace motiongan::fuzz
