// How the kernels of a context are compiled: precision, form, size of work-groups.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdlib>
#include <string_view>

#include "motiongan/core/device.hpp"

namespace motiongan {

/// Precision of a Context: f32 for training and sampling, f64 for gradient checks.
enum class Precision { f32, f64 };

/// Who shares a row of a softmax, a tile of a matrix product or a window of a search. narrow: one work-item
/// with long vectors, for the few cores of a CPU. wide: the items of a work-group, with local memory, for
/// devices that run thousands of items.
enum class KernelForm { narrow, wide };

/// The form that MOTIONGAN_KERNELS ("narrow" or "wide") names, else narrow for CPU devices and wide for all
/// others, and for Mesa's llvmpipe, whose version 22.3 crashes in the narrow form's convolutions and makes
/// wrong sums of several segments. Throws Error for another value.
inline KernelForm kernel_form(const Device& device) {
  const char* text = std::getenv("MOTIONGAN_KERNELS");
  const std::string_view name = text ? text : "";
  if (name == "narrow") return KernelForm::narrow;
  if (name == "wide") return KernelForm::wide;
  require(name.empty(), "MOTIONGAN_KERNELS is \"", name, "\", expected narrow or wide; or leave it unset");
  return device.is_cpu() && device.platform_name != "rusticl" ? KernelForm::narrow : KernelForm::wide;
}

namespace detail {

/// All that the build options of the kernels depend on.
struct KernelTarget {
  Precision precision = Precision::f32;
  KernelForm form = KernelForm::narrow;
  std::size_t group = 1;  ///< items of a work-group; GROUP in the wide form's kernels

  bool wide() const { return form == KernelForm::wide; }
};

/// The largest power of two that is at most 64, what the device allows and, unless 0, `limit`.
inline std::size_t group_size(const Device& device, std::size_t limit) {
  const std::size_t most = std::min<std::size_t>(64, std::max<std::size_t>(device.max_group, 1));
  return std::bit_floor(limit > 0 ? std::min(limit, most) : most);
}

}  // namespace detail
}  // namespace motiongan
