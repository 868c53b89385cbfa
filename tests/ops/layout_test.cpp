// Concatenation of many parts: eight are copied by one launch.
#include <doctest/doctest.h>

#include <motiongan/ops/layout.hpp>
#include <vector>

#include "../support/precision.hpp"

namespace layout_test {

using namespace motiongan;

TEST_CASE("any number of parts of any size lie one after the other, in rows too") {
  for (const Precision precision : testing::precisions()) {
    const Context context(ContextOptions{.precision = precision});
    for (const std::size_t rows : {std::size_t{1}, std::size_t{3}})
      for (const std::size_t count : {1u, 7u, 8u, 9u, 20u}) {
        CAPTURE(rows);
        CAPTURE(count);
        std::vector<Var> parts;
        std::vector<std::vector<double>> expected(rows);
        double next = 0;
        for (std::size_t p = 0; p < count; ++p) {
          const std::size_t width = p % 5 == 2 ? 0 : 1 + 13 * p % 40;
          std::vector<double> values;
          for (std::vector<double>& row : expected)
            for (std::size_t i = 0; i < width; ++i) {
              values.push_back(++next);
              row.push_back(next);
            }
          parts.push_back(Var::constant(Tensor::from(context, {rows, width}, values)));
        }
        const std::size_t launches = context.statistics().launches;
        const std::vector<double> joined = concatenate(parts, 1).value().to_host<double>();
        CHECK(context.statistics().launches - launches == (count + 7) / 8);
        std::vector<double> all;
        for (const std::vector<double>& row : expected) all.insert(all.end(), row.begin(), row.end());
        CHECK(joined == all);
      }
  }
}

}  // namespace layout_test
