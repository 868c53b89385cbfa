// What a model in training makes of fixed prompts, on a page that is written anew every few minutes.
#pragma once
#include "motiongan/train/run.hpp"
#include "shared/options.hpp"
#include "shared/show.hpp"

namespace motiongan::command {

/// Writes `preview.html` and `preview.png` to the folder of a run.
class Preview {
 public:
  /// Makes the motions to show with the model as it would be saved now.
  using Make = std::function<std::vector<view::ViewedMotion>(const io::SafeTensors& checkpoint)>;

  Preview(double minutes, fs::path folder, Make make)
      : seconds_(60 * minutes), folder_(std::move(folder)), make_(std::move(make)) {}

  /// To be called after every iteration. Writes the page if it is time for it.
  void update(Trainer& trainer) {
    if (seconds_ <= 0 || !make_ || clock_seconds() - last_ < seconds_) return;
    const std::vector<view::ViewedMotion> motions = make_(checkpoint_of(trainer));
    const std::string title = fmt::format("after {} iterations", trainer.iteration());
    view::write_player(folder_ / "preview.html", motions, {.title = title, .group = 2});
    write_png(folder_ / "preview.png", view::pose_strip(motions));
    last_ = clock_seconds();
  }

 private:
  double seconds_, last_ = clock_seconds();
  fs::path folder_;
  Make make_;
};

/// The number of prompts on the page, each with two motions.
inline constexpr std::size_t previewed = 6;

}  // namespace motiongan::command
