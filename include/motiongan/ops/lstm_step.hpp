// One step of an LSTM layer, for weights that are used in many steps: matrix product and cell, in one kernel
// where weights are packed.
#pragma once
#include "motiongan/core/gemm.hpp"
#include "motiongan/ops/reduce.hpp"

namespace motiongan::detail {

/// An optional kernel argument: a null buffer if empty.
template <class T>
struct Maybe {
  const T& value;
  std::size_t bytes() const { return value.bytes(); }
  std::string describe() const { return value.empty() ? "none" : value.describe(); }
};
inline void add_argument(KernelArguments& to, const Maybe<Tensor>& tensor) {
  to.set(tensor.value.empty() ? static_cast<cl_mem>(nullptr) : tensor.value.buffer());
  add_argument(to, tensor.value.offset());
}
inline void add_argument(KernelArguments& to, const Maybe<Indices>& indices) {
  to.set(indices.value.empty() ? static_cast<cl_mem>(nullptr) : indices.value.buffer());
}

/// The operands of one step, each a tensor and the index of its first element.
struct LstmStep {
  std::size_t batch;
  At rows;            ///< the layer's input, [batch, in], in rows of `width`
  std::size_t width;  ///< row stride of `rows` and of `h`
  At extra;           ///< added to the gates: [batch, 4k] or, with extra_is_bias, [4k]
  bool extra_is_bias;
  At c_before, h, c;  ///< [batch, k], h in rows of `width`
  At gates;           ///< activated gates, [batch, 4k]
  bool keep_gates;    ///< whether gates are needed afterwards; if not, still used as scratch memory
  /// If not empty, a sample keeps its state from step lengths[b] on, see lstm_layer(); `rows` are then h of
  /// the step before, and this is step number `number`.
  Indices lengths = {};
  std::size_t number = 0;
};

/// One LSTM layer: gates = rows W^T + extra (order i, f, g, o), then c and h. The constructor packs W
/// [4k, in], on request in 16 bits (see GemmCall); later changes of W have no effect where weights are
/// packed.
class LstmStepper {
 public:
  LstmStepper() = default;
  LstmStepper(const Context& context, const Tensor& weight, bool in_16_bits = false)
      : weight_(weight), k_(weight.dim(0) / 4), in_(weight.dim(1)), kernels_(packed_kernels(in_16_bits)) {
    if (!packs_weights(context)) return;
    const std::size_t panels = 2 * vectors(context, k_);
    packed_ = packed_once(weight, {in_16_bits ? 5U : 4U, in_, k_}, [&] {
      Tensor packed = packed_panels(context, panels, in_, in_16_bits);
      context.launch(kernels_, "gemm_pack_gates",
                     LaunchGrid::groups(panels, (in_ + gemm_block(context) - 1) / gemm_block(context)),
                     weight, in_, k_, packed);
      return packed;
    });
  }

  void step(const LstmStep& s) const {
    if (s.batch == 0) return;
    const Context& context = weight_.context();
    const std::size_t extra_row = s.extra_is_bias ? 0 : 4 * k_, cells = s.batch * k_;
    const auto part = [](const At& at, std::size_t count) { return At{at.tensor, at.first, count}; };
    const At c_before = part(s.c_before, cells), c = part(s.c, cells), h = part(s.h, cells),
             gates = part(s.gates, 4 * cells);
    if (!packed_.empty()) {
      const std::size_t units = vectors(context, k_), wanted = 8 * context.device().compute_units;
      const std::size_t row_groups = std::max<std::size_t>(1, wanted / units), tile = 6;
      const std::size_t rows = ((s.batch + row_groups - 1) / row_groups + tile - 1) / tile * tile;
      context.count_gemm_flops(2.0 * static_cast<double>(s.batch * 4 * k_ * in_));
      context.launch(kernels_, "gemm_lstm_cell", LaunchGrid::groups(units, (s.batch + rows - 1) / rows),
                     part(s.rows, s.batch * in_), s.width, in_, packed_,
                     part(s.extra, s.extra_is_bias ? 4 * k_ : 4 * cells), extra_row, c_before, h, s.width, c,
                     gates, static_cast<cl_uint>(s.keep_gates), Maybe<Indices>{s.lengths}, s.number, s.batch,
                     k_, rows);
      return;
    }
    GemmCall call{.m = s.batch, .n = 4 * k_, .k = in_, .a = s.rows.tensor, .b = weight_, .c = s.gates.tensor};
    call.a_ld = s.width, call.b_ld = in_, call.c_ld = 4 * k_, call.b_transposed = true;
    call.a_offset[0] = s.rows.first, call.c_offset = s.gates.first;
    if (s.extra_is_bias)
      call.bias = s.extra.tensor;
    else
      call.residual = s.extra.tensor, call.residual_offset = s.extra.first, call.residual_ld = 4 * k_;
    gemm(context, call);
    context.launch("lstm", "lstm_cell", LaunchGrid::items(s.batch * vectors(context, k_)), gates, c_before,
                   part(s.rows, s.lengths.empty() ? 0 : cells), Maybe<Indices>{s.lengths}, s.number, h,
                   s.width, c, s.batch, k_);
  }

 private:
  Tensor weight_, packed_;
  std::size_t k_ = 0, in_ = 0;
  const char* kernels_ = "";
};

}  // namespace motiongan::detail
