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

}  // namespace detail

/// Enqueues the product. Throws an Error with the sizes when something does not lie inside its tensor. With k
/// = 0 the sum is what it starts from. On the native engine an element's value does not depend on m, n or the
/// batch.
inline void gemm(const Context& context, const GemmCall& call, GemmEngine engine = GemmEngine::automatic) {
  detail::check_gemm(context, call);
  if (call.m == 0 || call.n == 0 || call.batch == 0) return;
  context.count_gemm_flops(2.0 * static_cast<double>(call.m * call.n) *
                           static_cast<double>(call.k * call.segments * call.batch));
  if (engine == GemmEngine::automatic) engine = detail::gemm_engine_wish();
  if (engine == GemmEngine::automatic)
    engine = context.device().is_cpu() ? GemmEngine::native : GemmEngine::clblast;
  if (engine == GemmEngine::clblast && detail::clblast_can(call))
    detail::gemm_clblast(context, call);
  else
    detail::gemm_native(context, call);
}

}  // namespace motiongan
