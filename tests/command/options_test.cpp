// motiongan options: the tables of docs/options.md.
#include <doctest/doctest.h>

#include "command.hpp"

namespace options_test {

TEST_CASE("docs/options.md is what the command prints (./dev docs writes it anew)") {
  const TestFolder folder;
  const Said said = call("options");
  CHECK(said.status == 0);
  CHECK(said.has("| `--lambda` | `lambda_gp` | 10 | at least 0 |"));
  CHECK(said.has("| `--validation` | `validation` | dense | dense, mod2, final |"));
  CHECK(said.text == bytes_of(std::string(MOTIONGAN_SOURCE_DIR) + "/docs/options.md"));
}

}  // namespace options_test
