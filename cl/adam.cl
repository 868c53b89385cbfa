/// One Adam step (Kingma & Ba 2015; rounded as in torch.optim.Adam). m and v are the running means of the
/// gradient and its square; step_size = lr/(1-beta1^t), root_correction = sqrt(1-beta2^t). rest1 = 1-beta1
/// and rest2 = 1-beta2 are computed on the host in double: in float, 1 - 0.999f is off by 1e-5.
kernel void adam(global real* parameter, uint parameter0, global const real* gradient, uint gradient0,
                 global real* mean, uint mean0, global real* square, uint square0, uint n, real beta1,
                 real beta2, real rest1, real rest2, real step_size, real root_correction, real epsilon) {
  const uint i = (uint)get_global_id(0) * VW;
  if (i >= n) return;
  const uint left = n - i;
  const realv g = load_some(gradient + gradient0 + i, left);
  const realv m = load_some(mean + mean0 + i, left) * beta1 + g * rest1;
  const realv v = load_some(square + square0 + i, left) * beta2 + g * g * rest2;
  store_some(m, mean + mean0 + i, left);
  store_some(v, square + square0 + i, left);
  const realv p =
      load_some(parameter + parameter0 + i, left) - step_size * m / (sqrt(v) / root_correction + epsilon);
  store_some(p, parameter + parameter0 + i, left);
}
