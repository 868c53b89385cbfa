// Writes PNG files with libpng.
#pragma once
#include <png.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>

#include "motiongan/core/error.hpp"
#include "motiongan/view/canvas.hpp"

namespace motiongan {

/// Writes `image` to `path`; an existing file is replaced only by a complete one.
/// Throws Error if the image is empty or the file cannot be written.
inline void write_png(const std::filesystem::path& path, const view::Image& image) {
  require(image.width > 0 && image.height > 0 && image.rgb.size() == image.width * image.height * 3,
          "the picture for ", path.string(), " has ", image.width, " x ", image.height, " pixels and ",
          image.rgb.size(), " bytes; expected three bytes for every pixel and at least one pixel");
  std::filesystem::path beside = path;
  beside += ".tmp";
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  const int written = png_image_write_to_file(&png, beside.c_str(), 0, image.rgb.data(),
                                              static_cast<png_int_32>(image.width * 3), nullptr);
  std::error_code problem;
  if (written == 0) {
    std::filesystem::remove(beside, problem);
    throw Error("cannot write the picture ", path.string(), ": ", png.message,
                "; check that the folder exists, is writable and has space");
  }
  std::filesystem::rename(beside, path, problem);
  if (problem) {
    const std::string reason = problem.message();
    std::filesystem::remove(beside, problem);
    throw Error("cannot move the picture to ", path.string(), ": ", reason);
  }
}

}  // namespace motiongan
