// motiongan demo: a small model trained on the built-in motion, and what it learnt, in minutes.
#include <algorithm>
#include <fstream>

#include "motiongan/motion/bvh.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/motion/procedural.hpp"
#include "motiongan/train/progress.hpp"
#include "motiongan/train/train.hpp"
#include "motiongan/view/line_plot.hpp"
#include "show.hpp"

namespace motiongan::command {
namespace {

struct DemoArgs {
  double minutes = 2;
  std::string out = "demo-out";
};

constexpr const char* marker = "made by motiongan demo";

/// An empty folder, made anew if an earlier demo made it; never somebody else's files.
void renew(const fs::path& out) {
  const fs::path note = out / "README.txt";
  if (fs::exists(out) && (!fs::is_directory(out) || !fs::is_empty(out))) {
    std::string first;
    std::ifstream in(note);
    std::getline(in, first);
    require(first == marker, out.string(),
            " is there already and was not made by the demo; choose another --out");
    for (const auto& entry : fs::directory_iterator(out)) fs::remove_all(entry.path());
  }
  make_folder(out);
  motion::write_text_atomically(note, std::string(marker) + "\n");
}

struct Pair {
  std::string caption, name;
  const motion::DatasetClip* real = nullptr;
};

}  // namespace

void add_demo(CLI::App&, Job&) { (void)renew; }
}  // namespace motiongan::command
