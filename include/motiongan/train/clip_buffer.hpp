// Clips stored on the device, and windows of them gathered into batches.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "motiongan/core/tensor.hpp"

namespace motiongan {

/// How a window is made relative to its own first frame: which columns are relative to it, and which are
/// rotated by its heading.
struct WindowForm {
  std::vector<cl_int> relative = {};  ///< [dof], 1 for each relative column; empty: none
  std::size_t x = 0, z = 0, yaw = 0;  ///< columns of the root's position and yaw; yaw = dof: no rotation
  double yaw_scale = 0;               ///< radians of yaw per unit of its column
};

/// The poses of all clips, concatenated, in one device buffer [all frames, dof]. A sampler chooses the
/// windows; gather() copies them into a batch.
class ClipBuffer {
 public:
  ClipBuffer() = default;
  /// `clips`: the poses of each clip, [frames, dof].
  ClipBuffer(const Context& context, std::size_t dof, const std::vector<std::span<const float>>& clips)
      : ClipBuffer(context, dof, clips, {.x = dof, .z = dof, .yaw = dof}) {}
  ClipBuffer(const Context& context, std::size_t dof, const std::vector<std::span<const float>>& clips,
             WindowForm form)
      : context_(context), form_(std::move(form)) {
    std::size_t total = 0;
    for (const std::span<const float> clip : clips) {
      first_rows_.push_back(total / dof);
      total += clip.size();
    }
    poses_ = Tensor(context, {total / dof, dof});
    for (std::size_t i = 0; i < clips.size(); ++i)
      poses_.view(first_rows_[i] * dof, {clips[i].size() / dof, dof}).write(clips[i]);
    if (form_.relative.empty()) form_.relative.assign(dof, 0);
    relative_ = Indices(context, form_.relative);
  }

  std::size_t dof() const { return poses_.dim(1); }

  /// The row of a frame of a clip in the buffer, for gather().
  cl_int row(std::size_t clip, std::size_t frame) const {
    return static_cast<cl_int>(first_rows_[clip] + frame);
  }

  /// Gathers windows [frames, rows, dof]: `frames` frames from each of the given rows, `stride` rows apart.
  /// Throws Error if a window exceeds the buffer.
  Tensor gather(const std::vector<cl_int>& rows, std::size_t frames, std::size_t stride = 1) const {
    Tensor out(*context_, {frames, rows.size(), dof()});
    const Indices first(*context_, rows);
    const long long span = frames > 0 ? static_cast<long long>((frames - 1) * stride) : 0;
    first.check_range("a window's first frame", 0, static_cast<long long>(poses_.dim(0)) - 1 - span);
    context_->launch("layout", "gather_windows", LaunchGrid::items(frames * rows.size()), poses_, first,
                     relative_, out, frames, rows.size(), dof(), stride, form_.x, form_.z, form_.yaw,
                     KernelReal{form_.yaw_scale});
    return out;
  }

 private:
  std::optional<Context> context_;
  std::vector<std::size_t> first_rows_;
  Tensor poses_;
  WindowForm form_;
  Indices relative_;
};

}  // namespace motiongan
