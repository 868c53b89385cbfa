// Words of printed command lines: what a shell makes of them is the text again.
#include "../../src/shared/shell.hpp"

#include <doctest/doctest.h>

#include "command.hpp"

namespace shell_test {

using motiongan::command::shell_quoted;
using motiongan::command::shell_word;

TEST_CASE("harmless texts look as a person would type them") {
  CHECK(shell_quoted("walk slowly, on uneven terrain") == "\"walk slowly, on uneven terrain\"");
  CHECK(shell_quoted("it's") == "\"it's\"");
  CHECK(shell_quoted("") == "\"\"");
  CHECK(shell_word("save/my-run_2") == "save/my-run_2");
  CHECK(shell_word("my run") == "\"my run\"");
  CHECK(shell_word("") == "\"\"");
  CHECK(shell_quoted("say \"hi\"") == "'say \"hi\"'");
  CHECK(shell_quoted("it's $5") == "'it'\\''s $5'");
}

TEST_CASE("a shell gives back every text") {
  const TestFolder folder;
  for (const std::string text : {"walk",
                                 "two words",
                                 "a \"quote\"",
                                 "it's",
                                 "$HOME",
                                 "$(touch made)",
                                 "`touch made`",
                                 "back\\slash",
                                 "a!b",
                                 "*",
                                 "~",
                                 "#x",
                                 "a;b",
                                 "a&b",
                                 "(x)",
                                 "{a,b}",
                                 "tab\there",
                                 "'",
                                 "''",
                                 "'\"'\\''\"'",
                                 "gehen \xc3\xbc"
                                 "ber"}) {
    CAPTURE(text);
    for (const std::string& word : {shell_quoted(text), shell_word(text)}) {
      const Said said = shell("printf '%s' " + word);
      CHECK(said.status == 0);
      CHECK(said.text == text);
    }
  }
  CHECK_FALSE(fs::exists("made"));
}

}  // namespace shell_test
