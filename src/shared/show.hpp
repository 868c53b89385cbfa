// Shows motions on an HTML page and in a picture; shared by generate, complete, search, view and demo.
#pragma once
#include <algorithm>
#include <span>

#include "motiongan/motion/motion.hpp"
#include "motiongan/view/player.hpp"
#include "motiongan/view/pose_strip.hpp"
#include "shared/command.hpp"
#include "shared/write_png.hpp"

namespace motiongan::command {

/// The largest number of frames of a motion that a page shows.
inline constexpr std::size_t most_shown = 3000;

/// The motion at `rate` (0: its own), cut to most_shown frames.
inline motion::Motion for_page(const motion::Motion& motion, double rate) {
  const motion::Motion shown = rate > 0 ? motion::resample(motion, rate) : motion;
  return shown.frames > most_shown ? slice(shown, 0, most_shown) : shown;
}

/// Writes the page and prints where. Each row shows `group` consecutive motions.
inline void show_page(const fs::path& path, std::span<const view::ViewedMotion> motions,
                      const std::string& title, std::size_t group = 1) {
  make_folder_of(path);
  view::write_player(path, motions, {.title = title, .group = group});
  fmt::print("wrote {}: {} side by side; open it in a browser\n", path.string(),
             counted(motions.size(), "motion"));
}

/// Writes a picture with a row of poses for each of the first 24 motions.
inline void show_strip(const fs::path& path, std::span<const view::ViewedMotion> motions) {
  constexpr std::size_t most = 24;
  make_folder_of(path);
  const auto shown = motions.first(std::min(most, motions.size()));
  write_png(path, view::pose_strip(shown));
  fmt::print("wrote {}: poses of {}\n", path.string(),
             shown.size() < motions.size() ? fmt::format("the first {} of {} motions", most, motions.size())
                                           : counted(shown.size(), "motion"));
}

}  // namespace motiongan::command
