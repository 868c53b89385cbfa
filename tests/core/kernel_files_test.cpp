// Helper functions of the kernel files are `static`: with C99's inline semantics, a plain `inline` function
// that a compiler does not inline is missing when the program is linked.
#include <doctest/doctest.h>

#include <motiongan/generated/kernels.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace kernel_files_test {

namespace {

/// The text without comments, in which a continued line is one line.
std::string plain(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = text.substr(i);
    if (rest.starts_with("\\\n")) {
      ++i;
    } else if (rest.starts_with("//")) {
      i += std::min(rest.find('\n'), rest.size()) - 1;
    } else if (rest.starts_with("/*")) {
      i += rest.find("*/") + 1;
    } else {
      out += text[i];
    }
  }
  return out;
}

bool is_letter(char c) { return c == '_' || std::isalnum(static_cast<unsigned char>(c)) != 0; }

/// The words and the other characters of a text.
std::vector<std::string> tokens_of(std::string_view text) {
  std::vector<std::string> tokens;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (std::isspace(static_cast<unsigned char>(text[i]))) continue;
    if (i > 0 && is_letter(text[i]) && is_letter(text[i - 1]))
      tokens.back() += text[i];
    else
      tokens.emplace_back(1, text[i]);
  }
  return tokens;
}

bool has(const std::vector<std::string>& tokens, const char* wanted) {
  for (const std::string& token : tokens)
    if (token == wanted) return true;
  return false;
}

/// The functions that `code` defines outside of others and that are neither static nor kernels.
std::vector<std::string> open_functions(std::string_view code) {
  std::vector<std::string> found, head;
  int depth = 0;
  for (const std::string& token : tokens_of(code)) {
    if (token == "{" && depth++ == 0) {
      const bool statement = head.empty() || head[0] == "if" || head[0] == "for" || head[0] == "while" ||
                             head[0] == "do" || head[0] == "else";
      if (!statement && has(head, "(") && !has(head, "=") && !has(head, "kernel") && !has(head, "static")) {
        std::string text;
        for (const std::string& word : head) text += word + " ";
        found.push_back(text);
      }
    } else if (token == "}") {
      --depth;
    }
    if (token == "}" || token == ";" || token == "{")
      head.clear();
    else if (depth == 0)
      head.push_back(token);
  }
  return found;
}

/// The open functions of a file: those of its text and those that its macros define.
std::vector<std::string> check_file(std::string_view text) {
  std::vector<std::string> found;
  std::string code;
  const std::string source = plain(text);
  for (std::size_t at = 0; at < source.size();) {
    const std::size_t end = std::min(source.find('\n', at), source.size());
    std::string line = source.substr(at, end - at);
    at = end + 1;
    if (!line.starts_with("#")) {
      code += line + "\n";
    } else if (line.starts_with("#define ")) {
      std::size_t body = 8;
      while (body < line.size() && is_letter(line[body])) ++body;
      if (body < line.size() && line[body] == '(') body = line.find(')', body) + 1;
      for (const std::string& name : open_functions(line.substr(body))) found.push_back(name);
    }
  }
  for (const std::string& name : open_functions(code)) found.push_back(name);
  return found;
}

}  // namespace

TEST_CASE("every function of the kernel files is static or a kernel") {
  std::size_t files = 0;
  for (const auto& file : motiongan::kernels::files) {
    CAPTURE(file.name);
    for (const std::string& function : check_file(file.text)) FAIL_CHECK(function);
    ++files;
  }
  CHECK(files >= 14);
}

TEST_CASE("the check sees open functions, in macros too, and none elsewhere") {
  CHECK(check_file("inline real twice(real v) { return 2 * v; }").size() == 1);
  CHECK(check_file("/* static */ real twice(real v) { if (v > 0) { return 2 * v; } return 0; }").size() == 1);
  CHECK(check_file("#define DEFINE(R) \\\n  inline void f##R(int a) { g(a); }\nDEFINE(1)").size() == 1);
  CHECK(check_file("static inline real twice(real v) { return 2 * v; }\n// real f() {\n").empty());
  CHECK(check_file("kernel void k(global real* x) { for (uint i = 0; i < 2; ++i) { x[i] = 0; } }").empty());
  CHECK(check_file("constant int table[] = {1, 2};\n#define STEP(i) if (n > i) { run(i); }").empty());
}

}  // namespace kernel_files_test
