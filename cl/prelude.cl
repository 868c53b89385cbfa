// Put in front of every kernel file. REAL is float or double, VW the device's vector width in REALs (4, 8 or 16; 2 for
// double on narrow CPUs). Kernels see a tensor as (buffer, index of its first element) and count in 32 bits.
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
typedef JOIN(REAL_BITS, VW) maskv;  // what a comparison of two realv gives
#define vload JOIN(vload, VW)
#define vstore JOIN(vstore, VW)

/// Sum over the lanes of a vector, always in the same order.
inline real lane_sum(realv v) {
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
