// Device selection, on made-up lists of devices.
#include <doctest/doctest.h>

#include <motiongan/core/device.hpp>

namespace device_test {

using namespace motiongan;

namespace {

Device made(const char* name, const char* platform, cl_device_type type) {
  Device device;
  device.name = name;
  device.platform_name = platform;
  device.type = type;
  return device;
}

/// A CPU first: the loader's order is not a ranking.
const std::vector<Device> four{
    made("pthread-epyc", "Portable Computing Language", CL_DEVICE_TYPE_CPU),
    made("GeForce RTX 3060", "NVIDIA CUDA", CL_DEVICE_TYPE_GPU),
    made("GeForce RTX 4090", "NVIDIA CUDA", CL_DEVICE_TYPE_GPU),
    made("Odd: 7", "Somebody's Accelerators", CL_DEVICE_TYPE_ACCELERATOR),
};

std::string chosen(std::string_view wish, const std::vector<Device>& among = four) {
  return choose_device(among, wish).name;
}

std::string message(std::string_view wish, const std::vector<Device>& among = four) {
  try {
    choose_device(among, wish);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

bool says(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("default: the first GPU, else the first device") {
  CHECK(chosen("") == "GeForce RTX 3060");
  CHECK(chosen("", {four[0], four[3]}) == "pthread-epyc");
  CHECK(chosen("", {four[3], four[0]}) == "Odd: 7");
}

TEST_CASE("selection by kind, by part of the name in any case, and by platform") {
  CHECK(chosen("cpu") == "pthread-epyc");
  CHECK(chosen("CPU") == "pthread-epyc");
  CHECK(chosen("gpu") == "GeForce RTX 3060");
  CHECK(chosen("4090") == "GeForce RTX 4090");
  CHECK(chosen("geforce rtx 4") == "GeForce RTX 4090");
  CHECK(chosen("nvidia") == "GeForce RTX 3060");
  CHECK(chosen("portable") == "pthread-epyc");
  CHECK(chosen("accelerators") == "Odd: 7");
}

TEST_CASE("an index selects a later match") {
  CHECK(chosen("gpu:0") == "GeForce RTX 3060");
  CHECK(chosen("gpu:1") == "GeForce RTX 4090");
  CHECK(chosen("NVIDIA:1") == "GeForce RTX 4090");
  CHECK(chosen("cpu:0") == "pthread-epyc");
  CHECK(chosen(":3") == "Odd: 7");
  CHECK(chosen("odd:") == "Odd: 7");  // the colon is part of the name
}

TEST_CASE("no match: the message has the request and the list of devices") {
  const std::string absent = message("gpu", {four[0], four[3]});
  CHECK(says(absent, "\"gpu\""));
  CHECK(says(absent, "0 match"));
  CHECK(says(absent, "cpu  pthread-epyc  (Portable Computing Language)"));
  CHECK(says(absent, "other  Odd: 7"));
  CHECK(says(absent, "NAME:index"));

  const std::string late = message("nvidia:2");
  CHECK(says(late, "2 match the name, index 2 requested"));
  CHECK(says(late, "gpu  GeForce RTX 4090"));

  CHECK(says(message("radeon"), "\"radeon\""));
  CHECK(says(message("gpu:x"), "\"gpu:x\""));
  CHECK(says(message("gpu:99999999999999999999999"), "no OpenCL device matches"));
}

TEST_CASE("no device at all: the message says what to install") {
  for (const char* wish : {"", "cpu", "gpu:1"}) {
    CHECK(says(message(wish, {}), "no OpenCL device found"));
    CHECK(says(message(wish, {}), "pocl-opencl-icd"));
  }
}

TEST_CASE("a default skips what cannot be used; a wish does not") {
  std::vector<Device> some = four;
  some[1].available = false;
  CHECK(chosen("", some) == "GeForce RTX 4090");
  CHECK(chosen("gpu", some) == "GeForce RTX 3060");
  CHECK(says(why_unusable(some[1]), "CL_DEVICE_AVAILABLE"));
  some[2].has_compiler = false;
  CHECK(chosen("", some) == "pthread-epyc");
  some[0].version = "OpenCL 1.1 of old";
  CHECK(chosen("", some) == "Odd: 7");
  some[3].c_version = "OpenCL C 1.0";
  CHECK(chosen("", some) == "pthread-epyc");  // none: a Context says why
}

TEST_CASE("OpenCL 1.2 is needed") {
  for (const char* version : {"OpenCL 1.2", "OpenCL 2.0 AMD", "OpenCL 3.0 PoCL", "OpenCL 10.0", "", "odd"}) {
    CAPTURE(version);
    Device device = four[0];
    device.version = version;
    CHECK(why_unusable(device).empty());
  }
  for (const char* version : {"OpenCL 1.1 CUDA", "OpenCL 1.0", "OpenCL 0.9"}) {
    Device device = four[0];
    device.version = version;
    CHECK(says(why_unusable(device), version));
  }
}

TEST_CASE("errors tell what failed while looking for devices") {
  const DeviceSurvey survey{{four[0]}, {"Broken: no device"}};
  const auto text = [](const DeviceSurvey& found, const char* wish) {
    try {
      choose_device(found, wish);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  CHECK(says(text(survey, "gpu"), "looking for others:\n  Broken: no device"));
  CHECK(says(text({{}, survey.problems}, ""), "What was found:\n  Broken: no device"));
  CHECK(says(text({{four[0]}, {}}, "gpu"), "cpu  pthread-epyc"));
}

TEST_CASE("the devices of this machine have a name, memory and a vector width") {
  const std::vector<Device> here = all_devices();
  REQUIRE_FALSE(here.empty());
  for (const Device& device : here) {
    CAPTURE(device.name);
    CHECK_FALSE(device.name.empty());
    CHECK_FALSE(device.platform_name.empty());
    CHECK(device.compute_units > 0);
    CHECK(device.global_memory > 0);
    CHECK(device.max_allocation > 0);
    CHECK(device.max_allocation <= device.global_memory);
    CHECK(choose_device(here, device.name).name == device.name);
  }
}

}  // namespace device_test
