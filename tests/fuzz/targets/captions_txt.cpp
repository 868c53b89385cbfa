// Captions of one clip, with the time ranges of HumanML3D.
#include "../captions.hpp"
#include "../memory_folder.hpp"

namespace motiongan::fuzz {

const Target captions_txt_target{"captions_txt", [](std::string_view bytes) {
                                   motion::CaptionFile file;
                                   motion::caption_detail::add_clip_text(
                                       file, "a", memory_folder().write("a.txt", bytes));
                                   demand_captions(file);
                                 }};

}  // namespace motiongan::fuzz
