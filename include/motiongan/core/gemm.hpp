// The one matrix product of the library: our kernel on CPU devices, CLBlast on others.
#pragma once
#include <cstdlib>
#include <string_view>

#include "motiongan/core/gemm_clblast.hpp"
#include "motiongan/core/gemm_native.hpp"

namespace motiongan {

/// Who multiplies: `automatic` is what MOTIONGAN_GEMM ("native" or "clblast") names, else native on CPU
/// devices and CLBlast on others.
enum class GemmEngine { automatic, native, clblast };

namespace detail {

/// What MOTIONGAN_GEMM asks for; read once.
inline GemmEngine gemm_engine_wish() {
  static const GemmEngine wish = [] {
    const char* text = std::getenv("MOTIONGAN_GEMM");
    const std::string_view name = text ? text : "";
    if (name.empty()) return GemmEngine::automatic;
    if (name == "native") return GemmEngine::native;
    if (name == "clblast") return GemmEngine::clblast;
    throw Error("MOTIONGAN_GEMM=\"", name, "\" names no engine: use native or clblast, or leave it unset");
  }();
  return wish;
}

/// Values of p that the native kernels pack at once: BLOCK of cl/gemm.cl.
inline std::size_t gemm_block(const Context& context) { return context.device().is_cpu() ? 768 : 32; }

inline GemmEngine choose_engine(const Context& context, GemmEngine engine) {
  if (engine == GemmEngine::automatic) engine = gemm_engine_wish();
  if (engine == GemmEngine::automatic)
    engine = context.device().is_cpu() ? GemmEngine::native : GemmEngine::clblast;
  return engine;
}

}  // namespace detail

/// B of a product that comes again and again, in the order in which the native engine reads it, segment after
/// segment; empty where another engine multiplies. Takes m, a and c of the call for unknown. To be made anew
/// when B changes.
inline Tensor pack_b(const Context& context, const GemmCall& call,
                     GemmEngine engine = GemmEngine::automatic) {
  if (detail::choose_engine(context, engine) != GemmEngine::native) return {};
  require(call.segments >= 1 && call.segments <= 4 && call.batch == 1 && call.n > 0 && call.k > 0 &&
              !call.b.empty(),
          "pack_b: a B of 1 to 4 segments and at least one row and column expected, no batch");
  const std::size_t columns = 2 * context.vector_width(), panels = detail::gemm_panels(context, call);
  const std::size_t block = detail::gemm_block(context), size = panels * call.k * columns;
  Tensor packed(context, {call.segments * panels, call.k, columns});
  for (std::size_t s = 0; s < call.segments; ++s) {
    detail::check_matrix(call, "B", call.b, call.b_offset[s], call.b_transposed ? call.n : call.k,
                         call.b_transposed ? call.k : call.n, call.b_ld, 0);
    context.launch("gemm_packed", "gemm_pack", LaunchGrid::groups(panels, (call.k + block - 1) / block),
                   detail::At{call.b, call.b_offset[s]}, call.b_transposed ? std::size_t{1} : call.b_ld,
                   call.b_transposed ? call.b_ld : std::size_t{1}, call.n, call.k,
                   detail::At{packed, s * size});
  }
  return packed;
}

/// Enqueues the product. Throws an Error with the sizes when something does not lie inside its tensor. With k
/// = 0 the sum is what it starts from. On the native engine an element's value does not depend on m, n or the
/// batch.
inline void gemm(const Context& context, const GemmCall& call, GemmEngine engine = GemmEngine::automatic) {
  detail::check_gemm(context, call);
  if (call.m == 0 || call.n == 0 || call.batch == 0) return;
  context.count_gemm_flops(2.0 * static_cast<double>(call.m * call.n) *
                           static_cast<double>(call.k * call.segments * call.batch));
  const bool native =
      detail::choose_engine(context, engine) != GemmEngine::clblast || !detail::clblast_can(call);
  if (native)
    detail::gemm_native(context, call);
  else
    detail::gemm_clblast(context, call);
  if (call.rectified.empty() || (native && !call.b_panels.empty())) return;  // nothing left to do
  context.launch("elementwise", "leaky_relu",
                 LaunchGrid::items((call.m * call.n + context.vector_width() - 1) / context.vector_width()),
                 detail::At{call.c, call.c_offset}, detail::At{call.rectified, call.rectified_offset},
                 call.m * call.n, KernelReal{0}, KernelReal{0});
}

}  // namespace motiongan
