// Prepended to every kernel file. REAL is float or double, VW the device's vector width in elements (2, 4, 8
// or 16). Kernels receive a tensor as (buffer, index of its first element) and index with 32 bits.
#ifdef REAL_IS_DOUBLE
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define REAL_BITS long
#else
#define REAL_BITS int
#endif

#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)

typedef REAL real;
typedef JOIN(REAL, VW) realv;
typedef JOIN(REAL_BITS, VW) maskv;  // the result of comparing two realv
// PoCL defines macros with these names.
#undef vload
#undef vstore
#define vload JOIN(vload, VW)
#define vstore JOIN(vstore, VW)

/// Sum over the lanes of a vector, in a fixed order.
static inline real lane_sum(realv v) {
#if VW == 16
  JOIN(REAL, 8) a = v.lo + v.hi;
  JOIN(REAL, 4) b = a.lo + a.hi;
#elif VW == 8
  JOIN(REAL, 4) b = v.lo + v.hi;
#else
  JOIN(REAL, VW) b = v;
#endif
#if VW == 2
  return b.x + b.y;
#else
  return (b.x + b.z) + (b.y + b.w);
#endif
}

/// Loads `left` (< VW) elements into the first lanes; the others are zero. Tails run through the same vector
/// code as full vectors, so that an element's value does not depend on its position in the array.
static inline realv load_part(global const real* p, uint left) {
  real lanes[VW];
  for (uint j = 0; j < VW; ++j) lanes[j] = j < left ? p[j] : (real)0;
  return vload(0, lanes);
}

static inline void store_part(realv v, global real* p, uint left) {
  real lanes[VW];
  vstore(v, 0, lanes);
  for (uint j = 0; j < left; ++j) p[j] = lanes[j];
}

// PoCL's vstoreN splits into pieces of 16 bytes; a vector type of lower alignment compiles to one
// instruction.
#ifdef FOR_CPU
#ifdef REAL_IS_DOUBLE
typedef realv realv_anywhere __attribute__((aligned(8)));
#else
typedef realv realv_anywhere __attribute__((aligned(4)));
#endif
#define LOAD_VECTOR(p) (*(global const realv_anywhere*)(p))
#define STORE_VECTOR(v, p) (*(global realv_anywhere*)(p) = (v))
#else
#define LOAD_VECTOR(p) vload(0, p)
#define STORE_VECTOR(v, p) vstore(v, 0, p)
#endif

// A bfloat16 is the upper half of a float; these functions hold it as the upper half of a uint.
typedef JOIN(uint, VW) bitsv;
/// The nearest bfloat16, ties to even.
static inline bitsv to_bf16(realv v) {
  const bitsv bits = JOIN(as_uint, VW)(JOIN(convert_float, VW)(v));
  return (bits + 0x7fff + ((bits >> 16) & 1)) & (uint)0xffff0000u;
}
static inline realv from_bf16(bitsv bits) { return JOIN(JOIN(convert_, REAL), VW)(JOIN(as_float, VW)(bits)); }

static inline realv sigmoid_v(realv v) { return 1 / (1 + exp(-v)); }

/// Loads min(left, VW) elements.
static inline realv load_some(global const real* p, uint left) {
  return left >= VW ? LOAD_VECTOR(p) : load_part(p, left);
}
static inline void store_some(realv v, global real* p, uint left) {
  if (left >= VW)
    STORE_VECTOR(v, p);
  else
    store_part(v, p, left);
}
