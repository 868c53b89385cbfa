// Writes PNG files with libpng.
#pragma once
#include <png.h>

#include <filesystem>
#include <string>

#include "motiongan/core/error.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/view/canvas.hpp"

namespace motiongan {

/// `image` as the bytes of a PNG file. Throws Error, naming the file `path`, if the image is empty.
inline std::string png_bytes(const std::filesystem::path& path, const view::Image& image) {
  require(image.width > 0 && image.height > 0 && image.rgb.size() == image.width * image.height * 3,
          "the picture for ", path.string(), " has ", image.width, " x ", image.height, " pixels and ",
          image.rgb.size(), " bytes; expected three bytes for every pixel and at least one pixel");
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  std::string out(PNG_IMAGE_PNG_SIZE_MAX(png), '\0');
  png_alloc_size_t size = out.size();
  const int made = png_image_write_to_memory(&png, out.data(), &size, 0, image.rgb.data(),
                                             static_cast<png_int_32>(image.width * 3), nullptr);
  require(made != 0, "cannot make the picture ", path.string(), ": ", png.message);
  out.resize(size);
  return out;
}

/// Writes `image` to `path`; an existing file is replaced only by a complete one.
/// Throws Error if the image is empty or the file cannot be written.
inline void write_png(const std::filesystem::path& path, const view::Image& image) {
  motion::write_text_atomically(path, png_bytes(path, image));
}

}  // namespace motiongan
