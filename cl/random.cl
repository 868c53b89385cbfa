// Counter-based random numbers: Philox 4x32-10 (Salmon et al., "Parallel random numbers: as easy as 1, 2, 3",
// SC 2011). A number depends only on (seed, stream, step, sample, position): a sample is the same in any
// batch.

#define LANES 16
typedef uint16 uintv;
typedef float16 floatv;

static inline void philox(uintv* counter0, uintv* counter1, uintv* counter2, uintv* counter3, uint key0,
                          uint key1) {
  uintv a = *counter0, b = *counter1, c = *counter2, d = *counter3;
  for (int round = 0; round < 10; ++round) {
    const uintv high0 = mul_hi(a, (uintv)(0xD2511F53u)), low0 = a * 0xD2511F53u;
    const uintv high1 = mul_hi(c, (uintv)(0xCD9E8D57u)), low1 = c * 0xCD9E8D57u;
    a = high1 ^ b ^ key0;
    b = low1;
    c = high0 ^ d ^ key1;
    d = low0;
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  *counter0 = a;
  *counter1 = b;
  *counter2 = c;
  *counter3 = d;
}

/// Uniform in (0, 1): never 0, so that its logarithm is finite.
static inline floatv unit(uintv bits) { return (convert_float16(bits >> 9) + 0.5f) * 0x1p-23f; }

/// Block number `block` of a row, 64 standard normal numbers by Box-Muller, of which the first `left` are
/// written. Lane l uses counter (block*16 + l, frame, sample, stream_step); its four words give the channels
/// block*64 + 16*q + l, q = 0 .. 3.
static inline void normal_block(global real* p, uint left, uint block, uint frame, uint sample,
                                uint stream_step, uint seed0, uint seed1) {
  const uintv lane = (uintv)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  uintv a = lane + block * 16, b = (uintv)(frame), c = (uintv)(sample), d = (uintv)(stream_step);
  philox(&a, &b, &c, &d, seed0, seed1);
  floatv values[4];
  const floatv radius0 = sqrt(-2 * log(unit(a))), radius1 = sqrt(-2 * log(unit(c)));
  floatv cosine;
  floatv sine = sincos(6.2831853071795865f * unit(b), &cosine);
  values[0] = radius0 * cosine;
  values[1] = radius0 * sine;
  sine = sincos(6.2831853071795865f * unit(d), &cosine);
  values[2] = radius1 * cosine;
  values[3] = radius1 * sine;
  for (uint q = 0; q < 4; ++q) {
#ifndef REAL_IS_DOUBLE
    if (left >= 16 * q + 16) {
      vstore16(values[q], q, p);
      continue;
    }
#endif
    float lanes[16];
    vstore16(values[q], 0, lanes);
    for (uint j = 0; j < 16 && 16 * q + j < left; ++j) p[16 * q + j] = lanes[j];
  }
}

/// out[t, b, c] ~ N(0, 1) for frame first_frame + t, plus frame_of[b] unless that is null. One work-item
/// generates 64 channels of one row.
kernel void random_normal(global real* out, uint out0, uint frames, uint batch, uint channels, uint seed0,
                          uint seed1, uint stream, uint step, uint first_sample, int first_frame,
                          global const int* frame_of) {
  const uint blocks = (channels + 63) / 64, item = get_global_id(0);
  const uint row = item / blocks, block = item % blocks;
  if (row >= frames * batch) return;
  const uint frame = (uint)((int)(row / batch) + first_frame + (frame_of ? frame_of[row % batch] : 0));
  normal_block(out + out0 + row * channels + block * 64, channels - block * 64, block, frame,
               first_sample + row % batch, stream ^ (step << 8), seed0, seed1);
}

/// The same at step 0 with one key per sample: keys[b] = (low word of the seed, high word, sample, frame),
/// [batch, 4].
kernel void random_normal_each(global real* out, uint out0, uint frames, uint batch, uint channels,
                               uint stream, int first_frame, global const int* keys) {
  const uint blocks = (channels + 63) / 64, item = get_global_id(0);
  const uint row = item / blocks, block = item % blocks;
  if (row >= frames * batch) return;
  global const int* key = keys + row % batch * 4;
  normal_block(out + out0 + row * channels + block * 64, channels - block * 64, block,
               (uint)((int)(row / batch) + first_frame + key[3]), (uint)key[2], stream, (uint)key[0],
               (uint)key[1]);
}

/// out[i] uniform in (0, 1), from the first word of counter (0, 0, first_sample + i, stream ^ step<<8).
kernel void random_uniform(global real* out, uint out0, uint n, uint seed0, uint seed1, uint stream,
                           uint step, uint first_sample) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  uintv a = 0, b = 0, c = (uintv)(first_sample + i), d = (uintv)(stream ^ (step << 8));
  philox(&a, &b, &c, &d, seed0, seed1);
  out[out0 + i] = unit(a).s0;
}

/// out[i] a uniform integer in [low, low + count), from the same counter.
kernel void random_integers(global int* out, uint n, int low, uint count, uint seed0, uint seed1, uint stream,
                            uint step, uint first_sample) {
  const uint i = get_global_id(0);
  if (i >= n) return;
  uintv a = 0, b = 0, c = (uintv)(first_sample + i), d = (uintv)(stream ^ (step << 8));
  philox(&a, &b, &c, &d, seed0, seed1);
  out[i] = low + (int)mul_hi(a.s0, count);  // the bias of this scaling is below count / 2^32
}
