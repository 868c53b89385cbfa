// Stochastic gradient descent with gradient norm clipping over all parameters.

/// parameter -= rate * gradient, with the gradient scaled down to norm `longest` if its norm exceeds that;
/// `square` [1] is the squared norm. longest = 0: no limit.
kernel void sgd(global real* parameter, uint parameter0, global const real* gradient, uint gradient0,
                global const real* square, uint square0, uint n, real rate, real longest) {
  const uint i = (uint)get_global_id(0) * VW;
  if (i >= n) return;
  const uint left = n - i;
  const real norm = longest > 0 ? sqrt(square[square0]) : (real)0;
  const real scale = norm > longest ? longest / norm : (real)1;
  store_some(load_some(parameter + parameter0 + i, left) -
                 rate * (load_some(gradient + gradient0 + i, left) * scale),
             parameter + parameter0 + i, left);
}
