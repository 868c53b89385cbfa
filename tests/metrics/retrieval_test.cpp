// Retrieval and inception score against values computed by hand.
#include <doctest/doctest.h>

#include <cmath>
#include <motiongan/metrics/inception_score.hpp>
#include <motiongan/metrics/retrieval.hpp>

#include "../support/messages.hpp"

namespace retrieval_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {
using Right = std::vector<std::vector<std::size_t>>;
}

TEST_CASE("ranks start at one, and ties count against") {
  const std::vector<float> scores{3, 1, 2, 2};
  const auto rank = [&](std::size_t d, std::vector<std::size_t> right) { return rank_of(scores, d, right); };
  CHECK(rank(0, {0}) == 1);
  CHECK(rank(1, {1}) == 4);
  CHECK(rank(2, {2}) == 3);     // 3 ties
  CHECK(rank(2, {2, 3}) == 2);  // both are right, only 0 is better
  CHECK(rank(1, {1, 0}) == 3);
  CHECK(rank_of(std::vector<float>{1, NAN}, 0, std::vector<std::size_t>{0}) == 2);
}

TEST_CASE("recall by hand") {
  // Four samples over six descriptions; the ranks of the right ones are 1, 2, 4, 6.
  const std::vector<float> scores{9, 1, 1, 1, 1, 1,   //
                                  5, 4, 3, 2, 1, 0,   //
                                  5, 4, 3, 2, 1, 0,   //
                                  5, 4, 3, 2, 1, 0};  //
  const Retrieval r = retrieval(scores, 6, Right{{0}, {1}, {3}, {5}});
  CHECK(r.descriptions == 6);
  CHECK(r.samples == 4);
  CHECK(r.recall == Recall{25, 50, 75, 100});
  CHECK(r.mean_rank == doctest::Approx((1 + 2 + 4 + 6) / 4.0));
  REQUIRE(r.parts.size() == 4);
  CHECK(r.parts[2].description == 3);
  CHECK(r.parts[2].recall == Recall{0, 0, 100, 100});
  CHECK(r.parts[2].mean_rank == 4);
}

TEST_CASE("recall by description, and blind recall") {
  const Right right{{0}, {0}, {0}, {2, 1}};
  const std::vector<float> scores{2, 1, 0, 2, 1, 0, 0, 1, 2, 2, 1, 0};  // ranks 1, 1, 3, 2
  const Retrieval r = retrieval(scores, 3, right);
  CHECK(r.recall[0] == doctest::Approx(100 * 2.0 / 4));
  // For the last sample only description 0 is wrong, and ranked before both right ones.
  REQUIRE(r.parts.size() == 3);
  CHECK(r.parts[1].samples == 1);
  CHECK(r.parts[1].mean_rank == 2);
  CHECK(r.parts[2].mean_rank == 2);
  CHECK(r.by_description()[0] == doctest::Approx((100 * 2.0 / 3 + 0 + 0) / 3));
  CHECK(blind_recall(right) == Recall{75, 100, 100, 100});
}

TEST_CASE("random recall") {
  CHECK(random_recall(250) == Recall{0.4, 1.2, 2.0, 4.0});  // Table 1's random row
  CHECK(random_recall(15)[3] == doctest::Approx(66.7).epsilon(1e-3));
  CHECK(random_recall(4) == Recall{25, 75, 100, 100});
}

TEST_CASE("invalid scores are rejected") {
  CHECK(says(message_of([] {
               retrieval(std::vector<float>(5), 2, Right{{0}, {1}});
             }),
             "5 scores of 2 samples, expected 2 each"));
  CHECK(says(message_of([] { retrieval(std::vector<float>(2), 2, Right{{}}); }),
             "sample 0 has no right description"));
  CHECK(says(message_of([] { retrieval(std::vector<float>(2), 2, Right{{2}}); }),
             "description 2 is out of range"));
  CHECK(says(message_of([] { inception_score(std::vector<float>(5), 2); }), "5 scores over 2"));
}

TEST_CASE("inception score") {
  // Each sample certain of a different description: log K. All alike, or all uncertain: 0.
  CHECK(inception_score(std::vector<float>{100, 0, 0, 0, 100, 0, 0, 0, 100}, 3) ==
        doctest::Approx(std::log(3.0)));
  CHECK(inception_score(std::vector<float>{100, 0, 0, 100, 0, 0}, 3) == doctest::Approx(0));
  CHECK(inception_score(std::vector<float>{1, 1, 1, 2, 2, 2}, 3) == doctest::Approx(0));
  // p = (3/4, 1/4) and (1/4, 3/4): log 2 - H(1/4).
  const auto l3 = static_cast<float>(std::log(3.0));
  const double h = -0.75 * std::log(0.75) - 0.25 * std::log(0.25);
  CHECK(inception_score(std::vector<float>{l3, 0, 0, l3}, 2) == doctest::Approx(std::log(2.0) - h));
  // Large scores: only differences matter.
  CHECK(inception_score(std::vector<float>{5000 + l3, 5000, -3000, -3000 + l3}, 2) ==
        doctest::Approx(std::log(2.0) - h).epsilon(1e-3));
}

}  // namespace retrieval_test
