// Turns the fields of the library's option structs into command-line options, and into notes stored in
// checkpoints.
#pragma once
#include "motiongan/core/fields.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Whether the command line gives the option `name` of the verb.
bool given(const CLI::App& verb, const std::string& name);

/// Adds an option to the verb for each field that has one, with its help, default and range. `group` is the
/// heading in --help for fields that name none.
void add_options(CLI::App& verb, const FieldList& fields, const std::string& group);

/// The same for the fields whose keys are in `only` or, if that is empty, not in `without`.
struct OptionFilter {
  std::vector<std::string_view> only = {}, without = {};
};
void add_options(CLI::App& verb, const FieldList& fields, const std::string& group,
                 const OptionFilter& filter);

/// Rejects numbers outside the range and, if `whole`, those with a fraction.
CLI::Validator in_range(const Range& range, bool whole = false);

/// The fields as the text of a note: a JSON object whose keys are option names.
std::string note_of(const FieldList& fields);

/// Sets the fields that the command line of `verb` does not give from a note; `from` is the checkpoint, for
/// error messages. `of_data` are options that belong to the clips: if the command line names other clips,
/// neither these options nor the clips are taken from the note.
void take_note(const FieldList& fields, const CLI::App& verb, const std::string& note, const fs::path& from,
               const std::vector<std::string_view>& of_data = {});

}  // namespace motiongan::command
