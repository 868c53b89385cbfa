// Compiled kernels kept on disk: what is found again, and what is not.
#include <doctest/doctest.h>

#include <fstream>
#include <motiongan/core/kernel_cache.hpp>

#include "../support/folders.hpp"
#include "../support/setting.hpp"

namespace kernel_cache_test {

using namespace motiongan;
using detail::KernelCache;

namespace {

/// A device whose driver keeps no kernels itself.
Device forgetful_device() {
  Device device = choose_device(survey_devices(), "");
  device.platform_name = "A platform";
  return device;
}

}  // namespace

TEST_CASE("a binary is found again for the same source, options and device, and for no others") {
  const testing::Scratch scratch;
  const testing::Setting setting("MOTIONGAN_CACHE_DIR", (scratch.path / "kept" / "kernels").c_str());
  const Device device = forgetful_device();
  const std::string binary("a\0binary\n", 9);
  {
    const KernelCache cache(device);
    REQUIRE(cache);
    CHECK(cache.find("-DVW=4", "source").empty());
    cache.keep("-DVW=4", "source", binary);
    CHECK(cache.find("-DVW=4", "source") == binary);
  }
  const KernelCache cache(device);
  CHECK(cache.find("-DVW=4", "source") == binary);
  CHECK(cache.find("-DVW=8", "source").empty());
  CHECK(cache.find("-DVW=4", "other source").empty());
  Device other = device;
  other.name += " II";
  CHECK(KernelCache(other).find("-DVW=4", "source").empty());
  cache.keep("-DVW=4", "source", "a newer one");
  CHECK(cache.find("-DVW=4", "source") == "a newer one");
}

TEST_CASE("a damaged binary is as if it were not there") {
  const testing::Scratch scratch;
  const testing::Setting setting("MOTIONGAN_CACHE_DIR", scratch.path.c_str());
  const KernelCache cache(forgetful_device());
  cache.keep("", "source", "binary");
  const std::filesystem::path file = std::filesystem::directory_iterator(scratch.path)->path();
  const std::uintmax_t size = std::filesystem::file_size(file);
  SUBCASE("cut short") { std::filesystem::resize_file(file, size - 3); }
  SUBCASE("empty") { std::filesystem::resize_file(file, 0); }
  SUBCASE("another byte at its end") {
    std::fstream(file).seekp(static_cast<std::streamoff>(size) - 1).put('X');
  }
  CHECK(cache.find("", "source").empty());
}

TEST_CASE("without a folder that can be written, and for PoCL, nothing is kept") {
  const testing::Scratch scratch;
  const std::filesystem::path file = scratch.path / "file";
  std::ofstream(file) << "text";
  const Device device = forgetful_device();
  {
    const testing::Setting setting("MOTIONGAN_CACHE_DIR", file.c_str());
    const KernelCache cache(device);
    cache.keep("", "source", "binary");
    CHECK(cache.find("", "source").empty());
  }
  {
    const testing::Setting setting("MOTIONGAN_CACHE_DIR", "");
    CHECK_FALSE(KernelCache(device));
  }
  Device pocl = device;
  pocl.platform_name = "Portable Computing Language";
  CHECK_FALSE(KernelCache(pocl));
}

}  // namespace kernel_cache_test
