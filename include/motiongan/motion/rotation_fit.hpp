// Rotations that map rest directions to observed ones, for one bone or several.
#pragma once
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

/// A direction at rest and as observed, both unit vectors.
struct DirectionPair {
  Vec3 rest{}, seen{};
  double weight = 1;  ///< above 0
};

/// Some unit vector perpendicular to `v`, which must not be zero.
inline Vec3 any_normal(const Vec3& v) {
  const Vec3 axis = std::abs(v[0]) <= std::abs(v[1]) && std::abs(v[0]) <= std::abs(v[2]) ? Vec3{1, 0, 0}
                    : std::abs(v[1]) <= std::abs(v[2])                                   ? Vec3{0, 1, 0}
                                                                                         : Vec3{0, 0, 1};
  const Vec3 n = cross(v, axis);
  return scale(n, 1 / length(n));
}

/// `q` followed by the rotation about the unit vector `axis` that brings it nearest to `target`.
inline Quat twisted_towards(const Quat& q, const Vec3& axis, const Quat& target) {
  // twist(a) q . target = cos(a/2) q . target + sin(a/2) (axis q) . target, maximised by an arctangent.
  const Quat turned = multiply({0, axis[0], axis[1], axis[2]}, q);
  const double along = dot(turned, target), still = dot(q, target), n = std::hypot(along, still);
  if (n < 1e-12) return q;  // all angles are equally far
  return normalize(multiply({still / n, along / n * axis[0], along / n * axis[1], along / n * axis[2]}, q));
}

/// The shortest rotation from `rest` to `seen`, both unit vectors. If they are opposite it is not unique: the
/// one nearest to `previous`.
inline Quat shortest_rotation(const Vec3& rest, const Vec3& seen, const Quat& previous) {
  const Vec3 sum = add(rest, seen);
  const double n = length(sum);
  if (n > 1e-6) {
    // Rotate by twice the angle between `rest` and the half-way direction.
    const Vec3 half = scale(sum, 1 / n), axis = cross(rest, half);
    return normalize({dot(rest, half), axis[0], axis[1], axis[2]});
  }
  // Half a turn about any normal of `rest`, corrected by the small remainder (n is small, not 0).
  const Vec3 normal = any_normal(rest);
  const Quat half_turn{0, normal[0], normal[1], normal[2]};
  const Quat exact = multiply(shortest_rotation(scale(rest, -1), seen, {}), half_turn);
  return twisted_towards(exact, seen, previous);
}

/// Unit eigenvector of the largest eigenvalue of the symmetric matrix m [4, 4], by Jacobi rotations.
inline std::array<double, 4> largest_eigenvector(std::array<std::array<double, 4>, 4> m) {
  std::array<std::array<double, 4>, 4> vectors{};  // columns
  for (std::size_t i = 0; i < 4; ++i) vectors[i][i] = 1;
  for (int sweep = 0; sweep < 30; ++sweep) {
    double off = 0, all = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < 4; ++j) {
        all += m[i][j] * m[i][j];
        if (i != j) off += m[i][j] * m[i][j];
      }
    if (off <= 1e-34 * all) break;
    for (std::size_t p = 0; p < 3; ++p) {
      for (std::size_t q = p + 1; q < 4; ++q) {
        if (std::abs(m[p][q]) <= 1e-300) continue;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::hypot(theta, 1.0));
        const double c = 1 / std::hypot(t, 1.0), s = t * c;
        for (std::size_t k = 0; k < 4; ++k) {
          const double a = m[k][p], b = m[k][q];
          m[k][p] = c * a - s * b;
          m[k][q] = s * a + c * b;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          const double a = m[p][k], b = m[q][k];
          m[p][k] = c * a - s * b;
          m[q][k] = s * a + c * b;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          const double a = vectors[k][p], b = vectors[k][q];
          vectors[k][p] = c * a - s * b;
          vectors[k][q] = s * a + c * b;
        }
      }
    }
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < 4; ++i)
    if (m[i][i] > m[best][best]) best = i;
  return {vectors[0][best], vectors[1][best], vectors[2][best], vectors[3][best]};
}

/// The rotation R that minimises the weighted sum of |R rest - seen|^2 (Wahba's problem, Davenport's
/// q-method). What the pairs leave undetermined, as when all observed directions are collinear, is taken from
/// `previous`. The pairs must not be empty.
inline Quat best_rotation(std::span<const DirectionPair> pairs, const Quat& previous) {
  // q^T K q is the weighted sum of (R rest) . seen for the rotation R of the unit quaternion q.
  std::array<std::array<double, 4>, 4> k{};
  double weights = 0;
  for (const DirectionPair& p : pairs) {
    const auto& [u, v, w] = p;
    const double trace = dot(u, v);
    const Vec3 z = cross(u, v);
    k[0][0] += w * trace;
    for (std::size_t i = 0; i < 3; ++i) {
      k[0][i + 1] += w * z[i];
      k[i + 1][0] += w * z[i];
      for (std::size_t j = 0; j < 3; ++j)
        k[i + 1][j + 1] += w * (u[i] * v[j] + u[j] * v[i] - (i == j ? trace : 0));
    }
    weights += w;
  }
  // A pull towards `previous` that matters only where the pairs decide nothing: it moves what is well
  // determined by about 1e-11, and what is barely determined by less than 1e-5 of a bone.
  const std::array<double, 4> before{previous.w, previous.x, previous.y, previous.z};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) k[i][j] += 1e-11 * weights * before[i] * before[j];
  const std::array<double, 4> q = largest_eigenvector(k);
  return normalize({q[0], q[1], q[2], q[3]});
}

}  // namespace motiongan::motion
