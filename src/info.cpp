#include "command.hpp"
namespace motiongan::command {
void add_info(CLI::App&, Job&) {}
void add_compare(CLI::App&, Job&) {}
}  // namespace motiongan::command
