// Small synthetic collections of exponential-map text, in the folder layouts of Human3.6M and CMU.
#pragma once
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

namespace motiongan::testing {

/// A temporary folder, removed with its contents.
class ExpmapFolder {
 public:
  ExpmapFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "motiongan-expmap-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ExpmapFolder(const ExpmapFolder&) = delete;
  ExpmapFolder& operator=(const ExpmapFolder&) = delete;
  ~ExpmapFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }

  void write(const std::string& file, const std::string& text) const { write_at(path_ / file, text); }

  static void write_at(const std::filesystem::path& file, const std::string& text) {
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << text;
  }

 private:
  std::filesystem::path path_;
};

/// The value in a column of a synthetic file: a slow oscillation, different for each column; column 8 is
/// constant.
inline double swing(std::size_t frame, std::size_t column, double phase) {
  if (column == 8) return 0.25;
  return 0.4 * std::sin(0.03 * static_cast<double>(frame) * (1 + 0.2 * static_cast<double>(column)) + phase);
}

inline std::string swings(std::size_t frames, double phase, std::size_t columns = 15) {
  std::string out;
  char text[32];
  for (std::size_t f = 0; f < frames; ++f)
    for (std::size_t c = 0; c < columns; ++c) {
      std::snprintf(text, sizeof text, "%.7g", swing(f, c, phase));
      out += text + std::string(c + 1 < columns ? "," : "\n");
    }
  return out;
}

/// Two actions, with training subjects S1 and S11 and test subject S5.
inline void write_small_h36m(const std::filesystem::path& folder) {
  double phase = 0;
  for (const char* file : {"S1/walking_1", "S1/walking_2", "S1/eating_1", "S1/eating_2", "S11/walking_1",
                           "S5/walking_1", "S5/walking_2", "S5/eating_1", "S5/eating_2"})
    ExpmapFolder::write_at(folder / (std::string(file) + ".txt"),
                           swings(file[1] == '5' ? 350 : 200, phase += 0.3));
}

/// Two actions, one of them without training files.
inline void write_small_cmu(const std::filesystem::path& folder) {
  double phase = 0;
  for (const char* file : {"train/walking/walking_1", "train/walking/walking_2", "test/walking/walking_1",
                           "test/washwindow/washwindow_1"})
    ExpmapFolder::write_at(folder / (std::string(file) + ".txt"), swings(200, phase += 0.3));
}

}  // namespace motiongan::testing
