// Writing BVH while motion is being generated.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/bvh_writer.hpp"
#include "motiongan/io/atomic_file.hpp"
#include "motiongan/motion/motion.hpp"

namespace motiongan::motion {

/// A BVH file written in pieces with bounded memory: byte for byte the file that write_bvh writes for the
/// pieces joined. BVH stores the number of frames in its header, so it must be known in advance.
///
/// The file is written next to `path` and renamed by finish(). Without finish() nothing is
/// left behind, and an existing file at `path` is untouched.
class BvhStreamWriter {
 public:
  /// Throws Error for a skeleton that BVH cannot hold, a rate that is not positive, or a file that cannot be
  /// opened.
  BvhStreamWriter(const std::filesystem::path& path, const Skeleton& skeleton, double rate,
                  std::size_t frames)
      : id_(path.stem().string()),
        rate_(rate),
        frames_(frames),
        width_(skeleton.channel_count()),
        encoder_(skeleton),
        header_(checked_header(skeleton)),
        file_(path) {
    file_.write(header_);
  }

  /// Appends a piece of the motion. Throws Error, and appends nothing, for another number of joints, another
  /// rate, more frames than announced, or a value that is not finite.
  void append(const Motion& piece) {
    require(!finished_, "BVH '", id_, "' is finished; nothing can be appended");
    require(std::abs(piece.rate / rate_ - 1) < 1e-6, "a piece of ", piece.rate,
            " frames per second was appended to BVH '", id_, "', expected ", rate_);
    require(piece.frames <= frames_ - written_, piece.frames, " frames were appended to BVH '", id_,
            "' after ", written_, ", expected at most the ", frames_, " announced");
    ChannelEncoder encoder = encoder_;  // a rejected piece must not change the angles
    std::vector<double> channels;
    channels.reserve(piece.frames * width_);
    encoder.append(piece, channels);
    bvh_detail::round_channels(channels);
    bvh_detail::check_finite(channels, width_, written_, id_);
    std::string text;
    const std::size_t block = 256 * std::max<std::size_t>(width_, 1);  // values formatted at a time
    for (std::size_t i = 0; i < channels.size(); i += block) {
      text.clear();
      bvh_detail::append_frames(text, std::span(channels).subspan(i, std::min(block, channels.size() - i)),
                                width_);
      file_.write(text);
    }
    encoder_ = std::move(encoder);
    written_ += piece.frames;
  }

  std::size_t written() const { return written_; }  ///< frames appended so far

  /// Completes the file at its path. Throws Error unless all announced frames were appended.
  void finish() {
    require(!finished_, "BVH '", id_, "' is finished already");
    require(written_ == frames_, "BVH '", id_, "' has ", written_, " frames, expected the ", frames_,
            " announced; append the rest");
    file_.commit();
    finished_ = true;
  }

 private:
  std::string checked_header(const Skeleton& skeleton) const {
    require(rate_ > 0, "motion '", id_, "' has a rate of ", rate_,
            " frames per second, expected more than 0");
    return bvh_detail::format_header(skeleton, frames_, 1.0 / rate_, id_);
  }

  std::string id_;
  double rate_;
  std::size_t frames_, width_, written_ = 0;
  ChannelEncoder encoder_;
  std::string header_;
  io::AtomicFile file_;
  bool finished_ = false;
};

}  // namespace motiongan::motion
