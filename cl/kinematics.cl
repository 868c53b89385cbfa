// Forward kinematics of a tree of joints, for many poses at once. Arrays are [3 * joints, poses] or [9 *
// joints, poses], so that a vector holds one number of VW poses. A joint's parent comes before it; joints
// without parent (-1) are at the origin.

typedef struct {
  realv m[9];
} Matrix;  // row by row

/// The rotation of an exponential map (x, y, z), I + a K + b K^2, of squared angle s: a = sin(t)/t, b = (1 -
/// cos(t))/t^2 with t = sqrt(s + 1e-12), which is never 0.
typedef struct {
  realv x, y, z, s, a, b;
} Turn;

static inline Turn turn_of(global const real* q, uint poses, uint joint, uint i, uint left) {
  global const real* r = q + 3 * joint * poses + i;
  Turn t;
  t.x = load_some(r, left), t.y = load_some(r + poses, left), t.z = load_some(r + 2 * poses, left);
  t.s = t.x * t.x + t.y * t.y + t.z * t.z;
  const realv squared = t.s + (real)1e-12, angle = sqrt(squared), half_sine = sin(angle / 2);
  t.a = sin(angle) / angle;
  t.b = 2 * half_sine * half_sine / squared;
  return t;
}

static inline Matrix matrix_of(Turn t) {
  const realv c = 1 - t.b * t.s;  // the cosine
  const realv xy = t.b * t.x * t.y, xz = t.b * t.x * t.z, yz = t.b * t.y * t.z;
  const realv x = t.a * t.x, y = t.a * t.y, z = t.a * t.z;
  return (Matrix){{c + t.b * t.x * t.x, xy - z, xz + y, xy + z, c + t.b * t.y * t.y, yz - x, xz - y, yz + x,
                   c + t.b * t.z * t.z}};
}

static inline Matrix load_matrix(global const real* p, uint poses, uint left) {
  Matrix out;
  for (uint e = 0; e < 9; ++e) out.m[e] = load_some(p + e * poses, left);
  return out;
}

/// Positions [3 * joints, poses] and global rotations [9 * joints, poses] of exponential maps q [3 * joints,
/// poses] and offsets [3 * joints] from the parents.
kernel void joint_positions(global const real* q, uint q0, global const real* offsets, uint offsets0,
                            global const int* parents, global real* positions, uint positions0,
                            global real* rotations, uint rotations0, uint joints, uint poses) {
  const uint i = (uint)get_global_id(0) * VW;
  if (i >= poses) return;
  const uint left = poses - i;
  q += q0, offsets += offsets0, positions += positions0 + i, rotations += rotations0 + i;
  for (uint j = 0; j < joints; ++j) {
    const Matrix own = matrix_of(turn_of(q, poses, j, i, left));
    const int p = parents[j];
    Matrix global_one = own;
    realv at[3] = {0, 0, 0};
    if (p >= 0) {
      const Matrix above = load_matrix(rotations + 9 * p * poses, poses, left);
      for (uint r = 0; r < 3; ++r) {
        realv sum = load_some(positions + (3 * p + r) * poses, left);
        for (uint c = 0; c < 3; ++c) sum += above.m[3 * r + c] * offsets[3 * j + c];
        at[r] = sum;
        for (uint c = 0; c < 3; ++c)
          global_one.m[3 * r + c] = above.m[3 * r] * own.m[c] + above.m[3 * r + 1] * own.m[3 + c] +
                                    above.m[3 * r + 2] * own.m[6 + c];
      }
    }
    for (uint r = 0; r < 3; ++r) store_some(at[r], positions + (3 * j + r) * poses, left);
    for (uint e = 0; e < 9; ++e) store_some(global_one.m[e], rotations + (9 * j + e) * poses, left);
  }
}

/// The gradient of a local rotation's exponential map from the gradient d of its matrix; da and db are the
/// derivatives of a and b with respect to s.
static inline void turn_gradient(Turn t, Matrix d, realv out[3]) {
  const realv r[3] = {t.x, t.y, t.z}, squared = t.s + (real)1e-12;
  const realv cosine = 1 - t.b * squared;
  // Near 0 the quotients lose all digits in single precision; their series do not.
  const realv da = squared < (real)1e-2
                       ? (real)(-1.0 / 6) + squared * ((real)(1.0 / 60) - squared * (real)(1.0 / 1680))
                       : (cosine - t.a) / (2 * squared);
  const realv db = squared < (real)1e-2
                       ? (real)(-1.0 / 24) + squared * ((real)(1.0 / 360) - squared * (real)(1.0 / 13440))
                       : (t.a / 2 - t.b) / squared;
  const realv twist[3] = {d.m[7] - d.m[5], d.m[2] - d.m[6], d.m[3] - d.m[1]};
  const realv trace = d.m[0] + d.m[4] + d.m[8];
  realv mixed[3], along = 0, about = 0;  // (d + d^T) r; r^T d r; the part of d along K
  for (uint e = 0; e < 3; ++e) {
    mixed[e] = 0;
    for (uint c = 0; c < 3; ++c) mixed[e] += (d.m[3 * e + c] + d.m[3 * c + e]) * r[c];
    along += mixed[e] * r[e] / 2;
    about += twist[e] * r[e];
  }
  const realv stretch = 2 * (da * about + db * (along - t.s * trace));
  for (uint e = 0; e < 3; ++e) out[e] = t.a * twist[e] + stretch * r[e] + t.b * (mixed[e] - 2 * trace * r[e]);
}

/// The gradient of q [3 * joints, poses] for the gradient g [3 * joints, poses] of the positions.
/// Scratch: 12 * joints numbers per pose, the gradients of positions and global rotations.
kernel void joint_positions_grad(global const real* q, uint q0, global const real* offsets, uint offsets0,
                                 global const int* parents, global const real* rotations, uint rotations0,
                                 global const real* g, uint g0, global real* scratch, uint scratch0,
                                 global real* out, uint out0, uint joints, uint poses) {
  const uint i = (uint)get_global_id(0) * VW;
  if (i >= poses) return;
  const uint left = poses - i;
  q += q0, offsets += offsets0, rotations += rotations0 + i, g += g0 + i, out += out0 + i;
  global real* at = scratch + scratch0 + i;
  global real* turned = at + 3 * joints * poses;
  for (uint k = 0; k < 3 * joints; ++k) store_some(load_some(g + k * poses, left), at + k * poses, left);
  for (uint k = 0; k < 9 * joints; ++k) store_some((realv)(0), turned + k * poses, left);
  for (uint j = joints; j-- > 0;) {
    const Turn turn = turn_of(q, poses, j, i, left);
    const int p = parents[j];
    Matrix d = load_matrix(turned + 9 * j * poses, poses, left);
    if (p >= 0) {
      const Matrix own = matrix_of(turn), above = load_matrix(rotations + 9 * p * poses, poses, left);
      Matrix up = load_matrix(turned + 9 * p * poses, poses, left), local_one;
      for (uint r = 0; r < 3; ++r) {
        const realv pull = load_some(at + (3 * j + r) * poses, left);
        global real* to = at + (3 * p + r) * poses;
        store_some(load_some(to, left) + pull, to, left);
        for (uint c = 0; c < 3; ++c) {
          up.m[3 * r + c] += pull * offsets[3 * j + c] + d.m[3 * r] * own.m[3 * c] +
                             d.m[3 * r + 1] * own.m[3 * c + 1] + d.m[3 * r + 2] * own.m[3 * c + 2];
          local_one.m[3 * r + c] =
              above.m[r] * d.m[c] + above.m[3 + r] * d.m[3 + c] + above.m[6 + r] * d.m[6 + c];
        }
      }
      for (uint e = 0; e < 9; ++e) store_some(up.m[e], turned + (9 * p + e) * poses, left);
      d = local_one;
    }
    realv gradient[3];
    turn_gradient(turn, d, gradient);
    for (uint r = 0; r < 3; ++r) store_some(gradient[r], out + (3 * j + r) * poses, left);
  }
}

/// For every pose 1 at the joint whose height [joints, poses] is least (the first of them), 0 at the others.
kernel void mark_lowest(global const real* heights, uint heights0, global real* out, uint out0, uint joints,
                        uint poses) {
  const uint i = get_global_id(0);
  if (i >= poses) return;
  heights += heights0 + i, out += out0 + i;
  uint lowest = 0;
  for (uint j = 1; j < joints; ++j)
    if (heights[j * poses] < heights[lowest * poses]) lowest = j;
  for (uint j = 0; j < joints; ++j) out[j * poses] = j == lowest;
}
