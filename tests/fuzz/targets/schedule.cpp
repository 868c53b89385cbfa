// Schedules of classes, such as walk:3s,run:5s; a first line, if there are two, is the total in seconds.
#include <charconv>
#include <motiongan/data/action_schedule.hpp>

#include "../target.hpp"

namespace motiongan::fuzz {

const Target schedule_target{"schedule", [](std::string_view bytes) {
                               motion::PositionFormat format;
                               format.classes = {"walk", "run"};
                               double total = 0;
                               if (const std::size_t end = bytes.find('\n'); end != bytes.npos) {
                                 std::from_chars(bytes.data(), bytes.data() + end, total);
                                 bytes.remove_prefix(end + 1);
                               }
                               for (const ActionPiece& piece : parse_action_schedule(bytes, format, total))
                                 demand(piece.label < 2 && piece.frames > 0,
                                        "a piece has a known class and frames");
                             }};

}  // namespace motiongan::fuzz
