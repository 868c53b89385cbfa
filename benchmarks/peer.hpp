// Times of the same work in PyTorch: finds Python interpreters that have it and runs a script in them.
#pragma once
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>
#include <memory>
#include <motiongan/core/error.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "../src/shared/shell.hpp"

namespace motiongan::bench {

/// The lines that a command prints; none if it cannot be run.
inline std::vector<std::string> output_lines(const std::string& command) {
  std::vector<std::string> lines;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::array<char, 4096> line{};
  while (pipe && std::fgets(line.data(), static_cast<int>(line.size()), pipe.get())) {
    lines.emplace_back(line.data());
    while (!lines.back().empty() && lines.back().back() == '\n') lines.back().pop_back();
  }
  return lines;
}

/// A Python interpreter and the version of its PyTorch.
struct Python {
  std::string program, torch;
};

/// The leading numbers of a version: "2.15.0+cpu" gives 2, 15, 0.
inline std::vector<int> version_numbers(const std::string& version) {
  std::vector<int> numbers(1, 0);
  for (const char c : version) {
    if (c == '.')
      numbers.push_back(0);
    else if (c >= '0' && c <= '9')
      numbers.back() = 10 * numbers.back() + c - '0';
    else
      break;
  }
  return numbers;
}

/// The interpreters to compare with: those named, or of the usual ones the one with the newest PyTorch.
/// Throws Error if a named one, or each of the usual ones, has none.
inline std::vector<Python> find_pythons(const std::vector<std::string>& named) {
  const std::vector<std::string> usual{"python3", "/usr/bin/python3"};
  std::vector<Python> found;
  for (const std::string& program : named.empty() ? usual : named) {
    const std::vector<std::string> lines = output_lines(
        command::shell_word(program) + " -c 'import torch; print(torch.__version__)' 2>/dev/null");
    if (lines.size() == 1)
      found.push_back({program, lines[0]});
    else
      require(named.empty(), program, " cannot import torch; install it there, or name another --python");
  }
  require(!found.empty(), "neither python3 nor /usr/bin/python3 can import torch; name one with --python");
  const auto older = [](const Python& a, const Python& b) {
    return version_numbers(a.torch) < version_numbers(b.torch);
  };
  if (named.empty()) found = {*std::max_element(found.begin(), found.end(), older)};
  return found;
}

/// Milliseconds by name as `SCRIPT speed --models MODELS` prints them, one JSON object per line.
inline std::map<std::string, double> peer_times(const Python& python, const std::string& script,
                                                const std::string& models) {
  std::map<std::string, double> times;
  for (const std::string& line :
       output_lines(command::shell_word(python.program) + " " + command::shell_word(script) +
                    " speed --models " + command::shell_word(models))) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_object() && json.contains("name") && json.contains("ms"))
      times[json.at("name").get<std::string>()] = json.at("ms").get<double>();
  }
  require(!times.empty(), script, " printed no times with ", python.program, " (torch ", python.torch, ")");
  return times;
}

}  // namespace motiongan::bench
