// The options that a checkpoint notes of its run, as JSON.
#include "../mutate_json.hpp"
#include "shared/captioned_data.hpp"
#include "shared/options.hpp"

namespace motiongan::fuzz {

const Target run_notes_target{
    "run_notes",
    [](std::string_view bytes) {
      command::CaptionedDataArgs args;
      CLI::App verb;
      command::add_captioned_data_options(verb, args);
      const FieldList fields = fields_of(args);
      command::take_note(fields, verb, std::string(bytes), "checkpoint");
      const std::string note = must("a note can be written", [&] { return command::note_of(fields); });
      must("a written note can be taken", [&] { command::take_note(fields, verb, note, "again"); });
    },
    mutate_json};

}  // namespace motiongan::fuzz
