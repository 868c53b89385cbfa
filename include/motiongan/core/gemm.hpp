// Matrix products: the library's own kernels on CPU devices, mostly CLBlast on all others.
#pragma once
#include <cstdlib>
#include <string_view>

#include "motiongan/core/gemm_clblast.hpp"
#include "motiongan/core/gemm_wide.hpp"
#include "motiongan/core/keep_packed.hpp"

namespace motiongan {

/// Which backend multiplies. `automatic`: the one that MOTIONGAN_GEMM ("native" or "clblast") names, else
/// native on CPU devices and CLBlast on all others, but for products of few rows in the wide form.
enum class GemmEngine { automatic, native, clblast };

namespace detail {
inline const ElementwiseKernel leaky_relu_kernel("leaky_relu", 1, "v < 0 ? a * v : v");  // keeps a NaN
}

namespace detail {

/// The value of MOTIONGAN_GEMM, read once.
inline GemmEngine gemm_engine_wish() {
  static const GemmEngine wish = [] {
    const char* text = std::getenv("MOTIONGAN_GEMM");
    const std::string_view name = text ? text : "";
    if (name.empty()) return GemmEngine::automatic;
    if (name == "native") return GemmEngine::native;
    if (name == "clblast") return GemmEngine::clblast;
    throw Error("MOTIONGAN_GEMM is \"", name, "\", expected native or clblast; or leave it unset");
  }();
  return wish;
}

/// Values of p that the native kernels pack at once: BLOCK in cl/gemm_tiles.cl.
inline std::size_t gemm_block(const Context& context) { return context.for_cpu() ? 768 : 32; }

inline GemmEngine choose_engine(const Context& context, GemmEngine engine) {
  if (engine == GemmEngine::automatic) engine = gemm_engine_wish();
  if (engine == GemmEngine::automatic)
    engine = context.device().is_cpu() ? GemmEngine::native : GemmEngine::clblast;
  return engine;
}

/// Whether products use packed weights, and convolutions Winograd's form: the native backend's narrow form.
inline bool packs_weights(const Context& context, GemmEngine engine = GemmEngine::automatic) {
  return !context.wide() && choose_engine(context, engine) == GemmEngine::native;
}

/// Whether the native backend computes a product. CLBlast's kernels are made for matrices of many rows: where
/// it was not asked for, those of few are left to ours (an estimate, not measured).
inline bool is_native(const Context& context, const GemmCall& call, GemmEngine engine) {
  constexpr std::size_t few = 32;
  const bool asked = engine != GemmEngine::automatic || gemm_engine_wish() != GemmEngine::automatic;
  return choose_engine(context, engine) == GemmEngine::native || !clblast_can(call) ||
         (!asked && context.wide() && call.m < few && call.batch == 1);
}

}  // namespace detail

/// Packs the B of a repeated product into the order in which the native backend reads it, segment after
/// segment, for GemmCall::b_panels: [segments * panels, k, 2 * vector width], or the same in 16 bits. Empty
/// on other backends and in the wide form. Ignores m, a and c of the call; must be repeated when B changes.
/// Throws Error for a batch, an empty B or a B outside its tensor.
inline Tensor pack_b(const Context& context, const GemmCall& call,
                     GemmEngine engine = GemmEngine::automatic) {
  if (!detail::packs_weights(context, engine)) return {};
  require(call.segments >= 1 && call.segments <= 4 && call.batch == 1 && call.n > 0 && call.k > 0 &&
              !call.b.empty(),
          "pack_b: expected 1 to 4 segments, batch 1 and a B with at least one row and column");
  const std::size_t panels = detail::gemm_panels(context, call), block = detail::gemm_block(context),
                    size = panels * call.k * detail::packed_row(context, call.b_in_16_bits);
  const detail::PackKey key{call.b_in_16_bits ? 3U : 1U,
                            call.n,
                            call.k,
                            call.b_ld,
                            call.b_transposed,
                            call.segments,
                            call.b_offset[0],
                            call.b_offset[1],
                            call.b_offset[2],
                            call.b_offset[3]};
  return detail::packed_once(call.b, key, [&] {
    Tensor packed = detail::packed_panels(context, call.segments * panels, call.k, call.b_in_16_bits);
    for (std::size_t s = 0; s < call.segments; ++s) {
      detail::check_matrix(call, "B", call.b, call.b_offset[s], call.b_transposed ? call.n : call.k,
                           call.b_transposed ? call.k : call.n, call.b_ld, 0);
      context.launch(detail::packed_kernels(call.b_in_16_bits), "gemm_pack",
                     LaunchGrid::groups(panels, (call.k + block - 1) / block),
                     detail::At{call.b, call.b_offset[s], call.n * call.k},
                     call.b_transposed ? std::size_t{1} : call.b_ld,
                     call.b_transposed ? call.b_ld : std::size_t{1}, call.n, call.k,
                     detail::At{packed, s * size, size});
    }
    return packed;
  });
}

/// Enqueues the product. With k = 0 the sum keeps its initial value. On the native backend an element's value
/// does not depend, bit for bit, on m, n or the batch. Throws Error, with all sizes, if an operand does not
/// lie inside its tensor.
inline void gemm(const Context& context, const GemmCall& call, GemmEngine engine = GemmEngine::automatic) {
  detail::check_gemm(context, call);
  if (call.m == 0 || call.n == 0 || call.batch == 0) return;
  context.count_gemm_flops(2.0 * static_cast<double>(call.m * call.n) *
                           static_cast<double>(call.k * call.segments * call.batch));
  context.count_bytes(detail::gemm_bytes(context, call));
  const bool native = detail::is_native(context, call, engine);
  if (!native)
    detail::gemm_clblast(context, call);
  else if (context.wide())
    detail::gemm_wide(context, call);
  else
    detail::gemm_native(context, call);
  if (call.rectified.empty() || (native && (context.wide() || !call.b_panels.empty()))) return;  // it is done
  context.launch("elementwise", detail::leaky_relu_kernel.name(),
                 LaunchGrid::items((call.m * call.n + context.vector_width() - 1) / context.vector_width()),
                 detail::At{call.c, call.c_offset, call.m * call.n},
                 detail::At{call.rectified, call.rectified_offset, call.m * call.n}, call.m * call.n,
                 KernelReal{0}, KernelReal{0});
}

}  // namespace motiongan
