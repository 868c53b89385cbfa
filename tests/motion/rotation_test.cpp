// Euler angles of every order, matrices, quaternions and exponential maps against each other and against
// hand-made values; continuity over time.
#include "motiongan/motion/rotation.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

namespace rotation_test {

using namespace motiongan;
using namespace motiongan::motion;

namespace {

/// Uniform numbers in [-1, 1], the same on every machine.
struct Numbers {
  std::uint64_t state = 12345;
  double operator()() {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<double>(state >> 11) / 4503599627370496.0 - 1.0;
  }
};

EulerOrder order_of(std::vector<std::size_t> axes) {
  std::vector<Channel> channels;
  for (const std::size_t a : axes) channels.push_back(static_cast<Channel>(3 + a));
  return EulerOrder(channels);
}

std::vector<std::vector<std::size_t>> all_orders() {
  std::vector<std::vector<std::size_t>> out{{}};
  for (std::size_t i = 0; i < 3; ++i) {
    out.push_back({i});
    for (std::size_t j = 0; j < 3; ++j) {
      out.push_back({i, j});
      for (std::size_t k = 0; k < 3; ++k) out.push_back({i, j, k});
    }
  }
  return out;
}

double difference(const Mat3& a, const Mat3& b) {
  double worst = 0;
  for (std::size_t i = 0; i < 9; ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

/// Plain product of textbook matrices, written without quaternions.
Mat3 reference(const EulerOrder& order, const Vec3& angles) {
  Mat3 m{1, 0, 0, 0, 1, 0, 0, 0, 1};
  for (std::size_t i = 0; i < order.count; ++i) {
    const double c = std::cos(angles[i]), s = std::sin(angles[i]);
    const std::array<Mat3, 3> about{Mat3{1, 0, 0, 0, c, -s, 0, s, c}, Mat3{c, 0, s, 0, 1, 0, -s, 0, c},
                                    Mat3{c, -s, 0, s, c, 0, 0, 0, 1}};
    m = multiply(m, about[order.axes[i]]);
  }
  return m;
}

}  // namespace

TEST_CASE("every Euler order converts to a matrix and back") {
  Numbers random;
  for (const auto& axes : all_orders()) {
    const EulerOrder order = order_of(axes);
    double worst = 0, worst_reference = 0;
    for (int i = 0; i < 500; ++i) {
      Vec3 angles{random() * 7, random() * 7, random() * 7};
      if (i % 5 == 0) angles = {std::round(angles[0]) * pi / 2, std::round(angles[1]) * pi / 2, angles[2]};
      if (i % 7 == 0) angles[1] = pi / 2 + 1e-9 * random();  // next to gimbal lock
      if (i % 11 == 0) angles[1] = 1e-9 * random();
      const Mat3 m = matrix_from_euler(order, angles);
      worst_reference = std::max(worst_reference, difference(m, reference(order, angles)));
      worst = std::max(worst, difference(m, matrix_from_euler(order, euler_from_matrix(order, m))));
    }
    CAPTURE(axes.size());
    CHECK(worst_reference < 1e-12);
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("Euler angles round-trip where they are unique") {
  Numbers random;
  for (const auto& axes : all_orders()) {
    const EulerOrder order = order_of(axes);
    if (order.count != 3 || axes[0] == axes[1] || axes[1] == axes[2]) continue;
    const bool proper = axes[0] == axes[2];
    for (int i = 0; i < 100; ++i) {
      const Vec3 a{3.1 * random(), proper ? 1.5 + 1.4 * random() : 1.5 * random(), 3.1 * random()};
      const Vec3 b = euler_from_quat(order, quat_from_euler(order, a));
      CHECK(length(subtract(a, b)) < 1e-12);
    }
  }
}

TEST_CASE("matrix, quaternion and exponential map round trips") {
  Numbers random;
  double worst = 0;
  for (int i = 0; i < 5000; ++i) {
    const double size = i % 4 == 0 ? pi : i % 4 == 1 ? 1e-6 : i % 4 == 2 ? 1e-160 : 3;
    Vec3 r{random(), random(), random()};
    r = scale(r, size * (i % 4 == 0 ? 1 - 1e-9 : std::abs(random())) / length(r));
    const Quat q = quat_from_expmap(r);
    CHECK(std::abs(dot(q, q) - 1) < 1e-15);
    worst = std::max(worst, length(subtract(expmap_from_quat(q), r)));
    const Mat3 m = matrix_from_quat(q);
    worst = std::max(worst, difference(m, matrix_from_quat(quat_from_matrix(m))));
    if (i % 4 != 0) worst = std::max(worst, length(subtract(expmap_from_matrix(m), r)));
    worst = std::max(worst, difference(multiply(m, transpose(m)), {1, 0, 0, 0, 1, 0, 0, 0, 1}));
    const Vec3 v{random(), random(), random()};
    const Vec3 rv{m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
                  m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
    worst = std::max(worst, length(subtract(rv, rotate(q, v))));
  }
  CHECK(worst < 1e-12);
  CHECK(expmap_from_quat({1, 0, 0, 0}) == Vec3{0, 0, 0});
  CHECK(expmap_from_quat({-1, 0, 0, 0}) == Vec3{0, 0, 0});
  CHECK_THROWS_AS(normalize({0, 0, 0, 0}), Error);
}

TEST_CASE("quaternion products are matrix products, inverses undo") {
  Numbers random;
  for (int i = 0; i < 200; ++i) {
    const Quat a = quat_from_expmap({3 * random(), random(), random()});
    const Quat b = quat_from_expmap({random(), 3 * random(), random()});
    CHECK(difference(matrix_from_quat(multiply(a, b)), multiply(matrix_from_quat(a), matrix_from_quat(b))) <
          1e-14);
    CHECK(angle_between(multiply(a, inverse(a)), Quat{}) < 1e-15);
  }
}

TEST_CASE("a quarter turn about z takes x to y") {
  const Vec3 v = rotate(quat_from_expmap({0, 0, pi / 2}), {1, 0, 0});
  CHECK(length(subtract(v, {0, 1, 0})) < 1e-15);
  // R = Rz(90) Rx(90): y goes to z by Rx and stays there by Rz.
  const Vec3 w = rotate(quat_from_euler(order_of({2, 0}), {pi / 2, pi / 2, 0}), {0, 1, 0});
  CHECK(length(subtract(w, {0, 0, 1})) < 1e-15);
}

TEST_CASE("slerp runs at constant speed along the shorter arc") {
  const Quat a = quat_from_expmap({0.3, -0.2, 1});
  const Quat b = multiply(a, quat_from_expmap({0, 2, 0}));
  const Quat far{-b.w, -b.x, -b.y, -b.z};  // the same rotation
  for (const double t : {0.0, 0.25, 0.5, 0.9, 1.0}) {
    CHECK(std::abs(angle_between(a, slerp(a, b, t)) - 2 * t) < 1e-14);
    CHECK(angle_between(slerp(a, b, t), slerp(a, far, t)) < 1e-14);
  }
  const Quat near = multiply(a, quat_from_expmap({1e-10, 0, 0}));
  CHECK(std::abs(angle_between(a, slerp(a, near, 0.5)) - 5e-11) < 1e-16);
  CHECK(angle_between(slerp(a, a, 0.3), a) < 1e-15);
}

TEST_CASE("fewer than three axes: the nearest rotation they can represent") {
  Numbers random;
  for (const auto& axes : all_orders()) {
    const EulerOrder order = order_of(axes);
    if (order.count == 0 || order.count == 3) continue;
    for (int i = 0; i < 50; ++i) {
      const Quat q = quat_from_expmap({2 * random(), 2 * random(), 2 * random()});
      const Vec3 best = euler_from_quat(order, q);
      const double error = angle_between(q, quat_from_euler(order, best));
      for (int k = 0; k < 40; ++k) {
        const Vec3 other{best[0] + 0.3 * random(), best[1] + 0.3 * random(), 0};
        CHECK(angle_between(q, quat_from_euler(order, other)) > error - 1e-12);
      }
    }
  }
}

TEST_CASE("gimbal lock keeps the given third angle and the rotation") {
  for (const auto& axes : all_orders()) {
    const EulerOrder order = order_of(axes);
    if (order.count != 3 || axes[0] == axes[1] || axes[1] == axes[2]) continue;
    const bool proper = axes[0] == axes[2];
    for (const double middle : proper ? std::vector{0.0, pi} : std::vector{pi / 2, -pi / 2}) {
      const Quat q = quat_from_euler(order, {0.7, middle, 0.4});
      const Vec3 free = euler_from_quat(order, q), kept = euler_from_quat(order, q, 0.4);
      CHECK(std::abs(free[2]) < 1e-15);
      CHECK(angle_between(q, quat_from_euler(order, free)) < 1e-12);
      CHECK(length(subtract(kept, {0.7, middle, 0.4})) < 1e-12);
    }
  }
}

TEST_CASE("an exponential map stays continuous through several turns") {
  const Vec3 axis = scale({0.6, -0.48, 0.64}, 1);
  Vec3 previous{};
  for (int i = 1; i <= 400; ++i) {
    const double angle = i * 0.1;  // 6 turns; never a multiple of pi
    const Vec3 r = unwrap_expmap(expmap_from_quat(quat_from_expmap(scale(axis, angle))), previous);
    CHECK(length(subtract(r, scale(axis, angle))) < 1e-11);
    previous = r;
  }
  for (int i = 400; i >= -400; --i) {
    const Vec3 r = unwrap_expmap(expmap_from_quat(quat_from_expmap(scale(axis, i * 0.1))), previous);
    CHECK(length(subtract(r, scale(axis, i * 0.1))) < 1e-11);
    previous = r;
  }
  // At a whole turn the previous axis is kept; near zero, nothing changes.
  CHECK(length(subtract(unwrap_expmap({0, 0, 0}, {0, 6.2, 0}), {0, 2 * pi, 0})) < 1e-12);
  CHECK(length(subtract(unwrap_expmap({1e-13, 0, 0}, {0, 6.2, 0}), {0, 2 * pi, 0})) < 1e-12);
  CHECK(unwrap_expmap({0, 0, 0}, {0.1, 0, 0}) == Vec3{0, 0, 0});
  CHECK(unwrap_expmap({0.2, 0, 0}, {0, 0, 0}) == Vec3{0.2, 0, 0});
  // Over the fold at pi: +3.1 and -3.1 are 0.08 apart.
  CHECK(length(subtract(unwrap_expmap({-3.1, 0, 0}, {3.1, 0, 0}), {2 * pi - 3.1, 0, 0})) < 1e-12);
}

TEST_CASE("Euler angles stay continuous over full turns and through the flip") {
  for (const auto& axes : all_orders()) {
    const EulerOrder order = order_of(axes);
    if (order.count != 3 || axes[0] == axes[1] || axes[1] == axes[2]) continue;
    Vec3 previous{0.013, 0.2, 0.011};
    for (int i = 0; i < 300; ++i) {
      const Vec3 truth{0.013 + 0.05 * i, 0.2 + 0.03 * i, 0.011 - 0.02 * i};
      const Vec3 a = euler_from_quat_near(order, quat_from_euler(order, truth), previous);
      CHECK(length(subtract(a, truth)) < 1e-9);
      previous = a;
    }
  }
  CHECK(unwrap_angle(radians(-179), radians(178)) == doctest::Approx(radians(181)));
}

TEST_CASE("more than three rotation channels are rejected") {
  const std::vector<Channel> four(4, Channel::x_rotation);
  CHECK_THROWS_WITH_AS(EulerOrder{four}, doctest::Contains("more than three rotation channels"), Error);
}

}  // namespace rotation_test
