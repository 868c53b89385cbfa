// Rotations as Euler angles of any order, matrices, quaternions and exponential maps, and unwrapping over
// time. Angles are in radians here; only BVH files use degrees. Vectors are columns: a rotation R maps v to R
// v, and Euler angles compose as R = R1 R2 R3.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "motiongan/core/error.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// Rotation matrix, row-major: element (row, column) is m[3 * row + column].
using Mat3 = std::array<double, 9>;

/// Half a turn, in radians.
inline constexpr double pi = std::numbers::pi;

/// Degrees to radians.
inline constexpr double radians(double degrees) { return degrees * (pi / 180); }
/// Radians to degrees.
inline constexpr double degrees(double radians) { return radians * (180 / pi); }

// ---- vectors

/// Arithmetic of vectors.
/// \{
inline Vec3 add(const Vec3& a, const Vec3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vec3 subtract(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Vec3 scale(const Vec3& a, double s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline double length(const Vec3& a) { return std::hypot(a[0], a[1], a[2]); }
/// \}

// ---- quaternions

/// The scalar product of two quaternions: 1 or -1 for unit quaternions of the same rotation.
inline double dot(const Quat& a, const Quat& b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }

/// The rotation b followed by a, in the order of matrix products: R(multiply(a, b)) = R(a) R(b).
inline Quat multiply(const Quat& a, const Quat& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/// Inverse of a unit quaternion.
inline Quat inverse(const Quat& q) { return {q.w, -q.x, -q.y, -q.z}; }

/// q scaled to unit length. Throws Error if q is zero or not finite.
inline Quat normalize(const Quat& q) {
  const double n = std::sqrt(dot(q, q));
  require(std::isfinite(n) && n > 0, "quaternion (", q.w, ", ", q.x, ", ", q.y, ", ", q.z,
          ") cannot be normalised: it must be finite and not zero");
  return {q.w / n, q.x / n, q.y / n, q.z / n};
}

/// The vector turned by a unit quaternion.
inline Vec3 rotate(const Quat& q, const Vec3& v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = scale(cross(u, v), 2);
  return add(v, add(scale(t, q.w), cross(u, t)));
}

/// Angle in [0, pi] of the rotation that takes a to b.
inline double angle_between(const Quat& a, const Quat& b) {
  const Quat d = multiply(inverse(a), b);
  return 2 * std::atan2(std::hypot(d.x, d.y, d.z), std::abs(d.w));
}

/// Spherical linear interpolation from a (t = 0) to b (t = 1) along the shorter arc.
inline Quat slerp(const Quat& a, const Quat& b, double t) {
  const double sign = dot(a, b) < 0 ? -1 : 1;
  const Quat d{sign * b.w - a.w, sign * b.x - a.x, sign * b.y - a.y, sign * b.z - a.z};
  const Quat s{sign * b.w + a.w, sign * b.x + a.x, sign * b.y + a.y, sign * b.z + a.z};
  // atan2 of the half angle stays precise where acos of the dot product does not.
  const double theta = 2 * std::atan2(std::sqrt(dot(d, d)), std::sqrt(dot(s, s)));
  const double denominator = std::sin(theta);
  const double wa = theta < 1e-8 ? 1 - t : std::sin((1 - t) * theta) / denominator;
  const double wb = sign * (theta < 1e-8 ? t : std::sin(t * theta) / denominator);
  return normalize({wa * a.w + wb * b.w, wa * a.x + wb * b.x, wa * a.y + wb * b.y, wa * a.z + wb * b.z});
}

// ---- matrices

/// The matrix product a b.
inline Mat3 multiply(const Mat3& a, const Mat3& b) {
  Mat3 c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      c[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
  return c;
}

/// The transpose, which is the inverse of a rotation.
inline Mat3 transpose(const Mat3& m) { return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}; }

/// The matrix of a unit quaternion.
inline Mat3 matrix_from_quat(const Quat& q) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy), 2 * (xy + wz),    1 - 2 * (xx + zz),
          2 * (yz - wx),     2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)};
}

/// The quaternion of a rotation matrix. The largest of its four components is chosen first, which avoids
/// dividing by a small number.
inline Quat quat_from_matrix(const Mat3& m) {
  const double w = 1 + m[0] + m[4] + m[8], x = 1 + m[0] - m[4] - m[8];
  const double y = 1 - m[0] + m[4] - m[8], z = 1 - m[0] - m[4] + m[8];
  Quat q;
  if (w >= x && w >= y && w >= z)
    q = {w, m[7] - m[5], m[2] - m[6], m[3] - m[1]};
  else if (x >= y && x >= z)
    q = {m[7] - m[5], x, m[1] + m[3], m[2] + m[6]};
  else if (y >= z)
    q = {m[2] - m[6], m[1] + m[3], y, m[5] + m[7]};
  else
    q = {m[3] - m[1], m[2] + m[6], m[5] + m[7], z};
  return normalize(q);
}

// ---- exponential maps: axis times angle

/// The rotation about r by |r|.
inline Quat quat_from_expmap(const Vec3& r) {
  const double angle = length(r);
  const double s = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
  return {std::cos(angle / 2), s * r[0], s * r[1], s * r[2]};
}

/// The shortest exponential map of q, of length at most pi.
inline Vec3 expmap_from_quat(const Quat& q) {
  const double s = std::hypot(q.x, q.y, q.z);
  const double sign = q.w < 0 ? -1 : 1;
  const double factor = sign * (s > 0 ? 2 * std::atan2(s, std::abs(q.w)) / s : 2);
  return {factor * q.x, factor * q.y, factor * q.z};
}

/// Of the exponential maps r (1 + 2 pi k / |r|), which are all the rotation r, the one nearest to `previous`.
/// A rotation of (nearly) zero has no axis of its own and takes that of `previous`.
inline Vec3 unwrap_expmap(const Vec3& r, const Vec3& previous) {
  const double angle = length(r);
  if (angle < 1e-12) {
    const double before = length(previous);
    const double turns = std::round(before / (2 * pi));
    return turns == 0 ? r : scale(previous, 2 * pi * turns / before);
  }
  const double along = dot(r, previous) / angle;
  const double turns = std::round((along - angle) / (2 * pi));
  return turns == 0 ? r : scale(r, 1 + 2 * pi * turns / angle);
}

/// The matrix of the rotation about r by |r|.
inline Mat3 matrix_from_expmap(const Vec3& r) { return matrix_from_quat(quat_from_expmap(r)); }
/// The shortest exponential map of a rotation, of length at most pi.
inline Vec3 expmap_from_matrix(const Mat3& m) { return expmap_from_quat(quat_from_matrix(m)); }

// ---- Euler angles

/// The axes of a joint's rotation channels in multiplication order: {2, 1, 0} is R = Rz Ry Rx. Up to three
/// axes, in any order; the first and third may be equal.
struct EulerOrder {
  std::array<std::size_t, 3> axes{};  ///< 0, 1 or 2 for x, y or z
  std::size_t count = 0;              ///< of axes

  EulerOrder() = default;

  /// The rotation channels in `channels`. Throws Error if there are more than three.
  explicit EulerOrder(std::span<const Channel> channels) {
    for (const Channel c : channels) {
      if (!is_rotation(c)) continue;
      require(count < 3, "a joint has more than three rotation channels, expected at most three");
      axes[count++] = axis(c);
    }
  }
};

/// The rotation by `angle` about x, y or z: axis 0, 1 or 2.
inline Quat axis_rotation(std::size_t axis, double angle) {
  Vec3 v{};
  v[axis] = std::sin(angle / 2);
  return {std::cos(angle / 2), v[0], v[1], v[2]};
}

/// The rotation R1 R2 R3 of the first `order.count` angles (radians).
inline Quat quat_from_euler(const EulerOrder& order, const Vec3& angles) {
  Quat q;
  for (std::size_t i = 0; i < order.count; ++i) q = multiply(q, axis_rotation(order.axes[i], angles[i]));
  return q;
}

/// `angle` plus the multiple of 2 pi that brings it nearest to `previous`.
inline double unwrap_angle(double angle, double previous) {
  return angle + 2 * pi * std::round((previous - angle) / (2 * pi));
}

/// Euler angles of q in radians. The middle one is in [-pi/2, pi/2] ([0, pi] for orders like ZXZ), the others
/// in [-pi, pi]. In gimbal lock, where the first and third axes coincide, the third angle is `third_in_lock`
/// and the first takes the rest. With fewer than three axes: the nearest rotation they can represent.
inline Vec3 euler_from_quat(const EulerOrder& order, const Quat& q, double third_in_lock = 0) {
  const std::array<double, 3> v{q.x, q.y, q.z};
  const auto [i, j, k] = order.axes;
  if (order.count == 0) return {};
  if (order.count == 1 || (order.count == 2 && i == j) || (order.count == 3 && i == j && j == k))
    return {unwrap_angle(2 * std::atan2(v[i], q.w), 0), 0, 0};
  if (order.count == 3 && (i == j || j == k)) {  // equal adjacent axes act as one
    EulerOrder two;
    two.axes = {i, i == j ? k : j, 0};
    two.count = 2;
    const Vec3 a = euler_from_quat(two, q);
    return i == j ? Vec3{a[0], 0, a[1]} : a;
  }
  const double sign = (j + 3 - i) % 3 == 1 ? 1 : -1;  // axis i times axis j = sign * axis (3 - i - j)
  const std::size_t other = 3 - i - j;
  if (order.count == 2) {
    // With half angles a and b, the dot product of q with Ri(2a) Rj(2b) splits into a term in a + b and one
    // in a - b, each maximised by an arctangent.
    const double sum = std::atan2(v[i] + v[j], q.w - sign * v[other]);
    const double difference = std::atan2(v[i] - v[j], q.w + sign * v[other]);
    return {unwrap_angle(sum + difference, 0), unwrap_angle(sum - difference, 0), 0};
  }
  // In half angles, Ri(a) Rj(b) Ri(c) has the components cos b cos(a + c), cos b sin(a + c) about i, sin b
  // cos(a - c) about j and sin b sin(a - c) about the third axis. Orders of three different axes reduce to
  // it: Ri(a) Rj(b) Rk(c) Rj(90 degrees) = Ri(a) Rj(b + 90 degrees) Ri(-sign c).
  const bool proper = i == k;
  const Quat p = proper ? q : multiply(q, axis_rotation(j, pi / 2));
  const std::array<double, 3> u{p.x, p.y, p.z};
  const double c = std::hypot(p.w, u[i]), s = std::hypot(u[j], u[other]);
  const double middle = 2 * std::atan2(s, c);
  const double half_sum = std::atan2(u[i], p.w), half_difference = std::atan2(sign * u[other], u[j]);
  const double third_sign = proper ? 1 : -sign;
  constexpr double lock = 1e-13;  // below it, a half angle is rounding noise
  double first = half_sum + half_difference, third = half_sum - half_difference;
  if (s < lock) {
    third = third_sign * third_in_lock;
    first = 2 * half_sum - third;
  } else if (c < lock) {
    third = third_sign * third_in_lock;
    first = 2 * half_difference + third;
  }
  return {unwrap_angle(first, 0), proper ? middle : middle - pi / 2, unwrap_angle(third_sign * third, 0)};
}

/// The same rotation as `angles`, as near to `previous` as full turns and, with three axes, the second
/// solution allow (first + 180, 180 - middle, third + 180 degrees; -middle for orders like ZXZ).
inline Vec3 unwrap_euler(const EulerOrder& order, const Vec3& angles, const Vec3& previous) {
  const auto nearest = [&](const Vec3& a) {
    Vec3 out{};
    for (std::size_t i = 0; i < order.count; ++i) out[i] = unwrap_angle(a[i], previous[i]);
    return out;
  };
  const Vec3 plain = nearest(angles);
  if (order.count < 3 || order.axes[0] == order.axes[1] || order.axes[1] == order.axes[2]) return plain;
  const bool proper = order.axes[0] == order.axes[2];
  const Vec3 flipped = nearest({angles[0] + pi, proper ? -angles[1] : pi - angles[1], angles[2] + pi});
  const Vec3 d = subtract(plain, previous), e = subtract(flipped, previous);
  return dot(d, d) <= dot(e, e) ? plain : flipped;
}

/// Euler angles of q as near to `previous` as possible, including in gimbal lock.
inline Vec3 euler_from_quat_near(const EulerOrder& order, const Quat& q, const Vec3& previous) {
  return unwrap_euler(order, euler_from_quat(order, q, previous[2]), previous);
}

/// The rotation of Euler angles in this order.
inline Mat3 matrix_from_euler(const EulerOrder& order, const Vec3& angles) {
  return matrix_from_quat(quat_from_euler(order, angles));
}
/// Euler angles of a rotation, see euler_from_quat().
inline Vec3 euler_from_matrix(const EulerOrder& order, const Mat3& m) {
  return euler_from_quat(order, quat_from_matrix(m));
}
/// The exponential map of Euler angles, of length at most pi.
inline Vec3 expmap_from_euler(const EulerOrder& order, const Vec3& angles) {
  return expmap_from_quat(quat_from_euler(order, angles));
}
/// Euler angles of an exponential map, see euler_from_quat().
inline Vec3 euler_from_expmap(const EulerOrder& order, const Vec3& r) {
  return euler_from_quat(order, quat_from_expmap(r));
}

}  // namespace motiongan::motion
