// The motiongan command: parses the command line and runs the verb. Each verb registers itself from its own
// file.
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>

#include "motiongan/core/os.hpp"
#include "shared/command_line.hpp"
#include "shared/shell.hpp"
#include "shared/signals.hpp"

int main(int argc, char** argv) {
  using namespace motiongan::command;
  motiongan::os::open_standard_streams();
  // Line-buffered, so that stdout and the progress on stderr keep their order when both go to one file.
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (argc > 0 && *argv[0] != '\0') program() = shell_word(argv[0]);
  try {
    CommandLine line(std::cout, std::cerr);
    const std::optional<int> parsed = line.parse({argv + (argc > 0 ? 1 : 0), argv + argc});
    const int status = parsed ? *parsed : line.run();
    flush_output();
    return status;
  } catch (const std::bad_alloc&) {
    std::fputs("motiongan: out of memory\n", stderr);
  } catch (const motiongan::DivergedError& error) {
    std::fprintf(stderr, "motiongan: %s\n", error.what());
    return exit_diverged;
  } catch (const std::filesystem::filesystem_error& error) {  // such as a link that leads to itself
    std::fprintf(stderr, "motiongan: %s cannot be reached: %s\n", error.path1().c_str(),
                 error.code().message().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "motiongan: %s\n", error.what());
  }
  // Also where a pipe broke and the error is that nothing more can be printed.
  return caught_signal() != 0 ? 128 + caught_signal() : exit_failure;
}
