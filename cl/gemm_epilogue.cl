// The arguments of a product, and what is done to an element of C at the end: shared by all products.

#define ACCUMULATE 1
#define BIAS 2
#define RESIDUAL 4
#define RELU 8
#define RECTIFY 16

// The epilogue of one element; the ReLU preserves NaN.
static inline real finish_one(real value, uint flags, global const real* bias, global const real* residual) {
  if (flags & BIAS) value += *bias;
  if (flags & RESIDUAL) value += *residual;
  return (flags & RELU) && value < 0 ? 0 : value;
}

// The arguments of a product as one struct, because PoCL has a cost per argument. Mirrors GemmNumbers on the
// host.
typedef struct {
  uint m, n, k, segments, flags;
  uint a_first, b_first, c_first, bias_first, residual_first;
  uint a_row, a_p, b_p, b_column, c_row,
      residual_row;  // strides: element (i, p) of A is a[i * a_row + p * a_p]
  uint a_batch, b_batch, c_batch;
  uint a_segment[4], b_segment[4];
  uint rows_per_group, panels_per_group, panels_at_once;
} Numbers;
