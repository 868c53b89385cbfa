// Acclaim motion files (.amc), the format of the CMU motion capture database.
#pragma once
#include <charconv>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/acclaim_lines.hpp"
#include "motiongan/formats/asf.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/motion/rotation.hpp"
#include "motiongan/motion/skeleton.hpp"

namespace motiongan::motion {

namespace acclaim_detail {

/// Reads an .amc file frame by frame.
class AmcReader {
 public:
  AmcReader(std::string_view text, const AsfSkeleton& asf, double rate, std::string_view name)
      : in_(text, name), asf_(asf), radians_(asf.radians), line_of_(asf.skeleton.size(), 0) {
    require(std::isfinite(rate) && rate > 0, name, ": the rate is ", rate,
            " frames per second, expected more than 0");
    out_.skeleton = asf.skeleton;
    out_.rate = rate;
  }

  Motion read() {
    while (in_.next()) {
      const std::string_view first = in_.words().front();
      if (first.starts_with(':'))
        read_keyword();
      else if (in_.words().size() == 1 && first.find_first_not_of("0123456789") == first.npos)
        start_frame();
      else
        read_bone();
    }
    require(out_.frames > 0, in_.file(), ": found no frames, expected a frame's number and a line per bone");
    finish_frame();
    return std::move(out_);
  }

 private:
  void read_keyword() {
    const std::string key = lower_case(in_.words().front());
    if (key == ":degrees" || key == ":radians") radians_ = key == ":radians";
    if (key != ":samples-per-second") return;  // others name the .asf file or the frames
    out_.rate = in_.real(1, "the number of frames per second");
    if (out_.rate <= 0) in_.fail("found ", out_.rate, " frames per second, expected more than 0");
  }

  void start_frame() {
    const std::string_view word = in_.words().front();
    unsigned long long number = 0;
    if (std::from_chars(word.data(), word.data() + word.size(), number).ec != std::errc())
      in_.fail("found ", Lines::quoted(word), ", expected the number of a frame");
    if (out_.frames > 0) {
      finish_frame();
      if (number != number_ + 1)
        in_.fail("found frame ", number, " after frame ", number_, ", expected frame ", number_ + 1);
    }
    number_ = number;
    frame_line_ = in_.number();
    ++out_.frames;
    for (const Joint& joint : asf_.skeleton.joints) {
      out_.rotations.emplace_back();
      out_.positions.push_back(joint.offset);
    }
  }

  /// Bones without degrees of freedom have no line; all others need one.
  void finish_frame() const {
    for (std::size_t j = 0; j < line_of_.size(); ++j)
      if (line_of_[j] < frame_line_ && !asf_.bones[j].values.empty())
        in_.fail_at(frame_line_, "frame ", number_, " has no line for bone '", asf_.skeleton.joints[j].name,
                    "', expected one");
  }

  void read_bone() {
    const std::string_view name = in_.words().front();
    if (out_.frames == 0) in_.fail("found ", Lines::quoted(name), ", expected the number of the first frame");
    const std::size_t j = joint_of(name);
    if (line_of_[j] > frame_line_)
      in_.fail("frame ", number_, " has a second line for bone '", name, "', expected one");
    line_of_[j] = in_.number();
    const AsfBone& bone = asf_.bones[j];
    const std::size_t found = in_.words().size() - 1;
    if (found != bone.values.size())
      in_.fail("bone '", name, "' has ", found, found == 1 ? " value" : " values", ", expected ",
               bone.values.size(), " as its degrees of freedom in the .asf file");
    if (found == 0) return;

    Vec3 shift{}, angles{};
    for (std::size_t i = 0; i < found; ++i) {
      const double value = in_.real(i + 1, "a bone's value");
      const std::size_t a = axis(bone.values[i]);
      if (is_rotation(bone.values[i]))
        angles[a] = radians_ ? value : radians(value);
      else
        shift[a] = value;
    }
    Quat turn;
    for (const std::size_t a : bone.order) turn = multiply(axis_rotation(a, angles[a]), turn);
    const std::size_t frame = out_.frames - 1;
    out_.rotation(frame, j) = multiply(multiply(bone.axis, turn), inverse(bone.axis));
    out_.position(frame, j) = add(out_.position(frame, j), shift);
  }

  /// The joint of this name, first looked for where the frame before had it.
  std::size_t joint_of(std::string_view name) {
    const std::size_t joints = asf_.skeleton.size();
    for (std::size_t i = 0; i < joints; ++i) {
      const std::size_t j = (next_ + i) % joints;
      if (asf_.skeleton.joints[j].name != name) continue;
      next_ = (j + 1) % joints;
      return j;
    }
    in_.fail("found the bone ", Lines::quoted(name),
             ", expected a bone of the .asf file; is it the right one?");
  }

  Lines in_;
  const AsfSkeleton& asf_;
  Motion out_;
  bool radians_;
  std::vector<std::size_t> line_of_;  ///< [joints], of the bone's last values
  unsigned long long number_ = 0;     ///< of the current frame
  std::size_t frame_line_ = 0, next_ = 0;
};

}  // namespace acclaim_detail

/// Reads an .amc text of the skeleton `asf`; `name` prefixes messages. Angles are in degrees or radians as
/// `:DEGREES` or `:RADIANS` says, else as in the .asf file; positions stay in the file's unit
/// (AsfSkeleton::unit_metres). `rate` is in frames per second; the file's own `:SAMPLES-PER-SECOND` takes
/// precedence. Throws Error as `name:line: ...` for a frame out of order, a bone that is unknown or missing,
/// a wrong number of values, and a value that is not finite.
inline Motion parse_amc(std::string_view text, const AsfSkeleton& asf, double rate, std::string_view name) {
  return acclaim_detail::AmcReader(text, asf, rate, name).read();
}

/// The .asf file of an .amc file: the one of the same name, else the subject's (07.asf for 07_01.amc), else
/// the only one in the folder. Throws Error if there is none of these.
inline std::filesystem::path find_asf(const std::filesystem::path& amc) {
  namespace fs = std::filesystem;
  std::error_code problem;
  const fs::path folder = amc.has_parent_path() ? amc.parent_path() : fs::path(".");
  const std::string stem = amc.stem().string();
  for (const std::string& name : {stem, stem.substr(0, stem.rfind('_'))})
    for (const char* const extension : {".asf", ".ASF"})
      if (fs::is_regular_file(folder / (name + extension), problem)) return folder / (name + extension);
  fs::path only;
  std::size_t found = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, problem)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.') || acclaim_detail::lower_case(entry.path().extension().string()) != ".asf")
      continue;
    only = entry.path();
    ++found;
  }
  require(found == 1, amc.string(), " needs the .asf file of its skeleton, and ", folder.string(), " has ",
          found, " .asf files, none called ", stem,
          ".asf: give the .asf file, or put it there under that name");
  return only;
}

/// Reads an .amc file with the skeleton of the file `asf`; if empty, of find_asf(path). `rate` is in frames
/// per second (120 in most CMU files, which do not store it). Throws Error if a file cannot be read or
/// parsed.
inline Motion read_amc(const std::filesystem::path& path, const std::filesystem::path& asf = {},
                       double rate = 120) {
  const std::string text = read_text(path, "AMC file");
  return parse_amc(text, read_asf(asf.empty() ? find_asf(path) : asf), rate, path.string());
}

}  // namespace motiongan::motion
