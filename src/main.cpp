// The motiongan command: parses the command line and runs the verb. Each verb registers itself from its own
// file.
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>

#include "shared/command_line.hpp"

int main(int argc, char** argv) {
  // Line-buffered, so that stdout and the progress on stderr keep their order when both go to one file.
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (argc > 0 && *argv[0] != '\0') motiongan::command::program() = argv[0];
  try {
    motiongan::command::CommandLine line(std::cout, std::cerr);
    const std::optional<int> status = line.parse({argv + (argc > 0 ? 1 : 0), argv + argc});
    return status ? *status : line.run();
  } catch (const std::bad_alloc&) {
    std::fputs("motiongan: out of memory\n", stderr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "motiongan: %s\n", error.what());
  }
  return 1;
}
