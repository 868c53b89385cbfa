// Shows motions side by side: an HTML page that works offline, and a picture in memory.
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main() {
  std::vector<view::ViewedMotion> shown;
  for (std::size_t i = 0; i < 4; ++i) {
    motion::LabelledMotion clip = motion::procedural_motion(i, {.seconds = 3});
    shown.push_back({clip.captions.front(), std::move(clip.motion)});
  }
  shown[0].seed_frames = 30;  // drawn in grey: given rather than generated frames
  view::write_player("motions.html", shown, {.title = "four motions"});

  // Pixels of three bytes each; writing a PPM file needs no library.
  const view::Image image = view::pose_strip(shown, {.poses = 8});
  std::FILE* file = std::fopen("poses.ppm", "wb");
  if (file == nullptr) return 1;
  std::fprintf(file, "P6\n%zu %zu\n255\n", image.width, image.height);
  const bool written = std::fwrite(image.rgb.data(), 1, image.rgb.size(), file) == image.rgb.size();
  if (std::fclose(file) != 0 || !written) return 1;
  std::printf("open motions.html in a browser; poses.ppm is %zu x %zu pixels\n", image.width, image.height);
}
