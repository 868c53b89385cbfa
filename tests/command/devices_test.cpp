// Devices through the command: what is listed, what is said when there is none, and a device that fails.
#include <doctest/doctest.h>

#include "command.hpp"

namespace devices_test {

namespace {

Said call_with(const std::string& environment, const std::string& arguments) {
  return shell("export " + environment + "; '" MOTIONGAN_COMMAND "' " + arguments);
}

}  // namespace

TEST_CASE("the devices are listed, the selected one is marked") {
  const Said said = call("devices");
  CHECK(said.status == 0);
  CHECK(said.has("* is the selected device"));
  CHECK_FALSE(said.has("cannot be used"));
  const Said none = call("devices --device absent");
  CHECK(none.status == 1);
  CHECK(none.has("none of these devices matches \"absent\""));
}

TEST_CASE("without a device, the command says what every platform answered") {
  const TestFolder folder;
  const Said no_platform = call_with("OCL_ICD_VENDORS=/none", "devices");
  CHECK(no_platform.status == 1);
  CHECK(no_platform.has("no OpenCL device found"));
  if (!call("devices").has("Portable Computing Language")) return;
  const std::string unwritable = "HOME=/nonexistent XDG_CACHE_HOME=/proc/none POCL_CACHE_DIR=/proc/none";
  for (const char* verb : {"devices", "train dvgan --procedural 4 --iterations 1 --save run"}) {
    const Said said = call_with(unwritable, verb);
    CAPTURE(said.text);
    CHECK(said.status == 1);
    CHECK(said.has("no OpenCL device found"));
    CHECK(said.has("Portable Computing Language: no device, clGetDeviceIDs failed with CL_"));
    CHECK(said.has("set POCL_CACHE_DIR to a folder that you can write"));
  }
}

TEST_CASE("buffers that fail end a training with an error; it resumes to the same bits") {
  const TestFolder folder;
  const std::string train = "train dvgan --procedural 6" + tiny;
  REQUIRE(call(train + "--save whole --iterations 3").status == 0);
  const auto fails = [&](int n, const std::string& arguments) {
    Said said = call_with("MOTIONGAN_FAIL_ALLOCATION=" + std::to_string(n), arguments);
    CAPTURE(n);
    CAPTURE(said.text);
    CHECK(said.status == 1);
    CHECK(said.has("motiongan: clCreateBuffer failed with CL_MEM_OBJECT_ALLOCATION_FAILURE (-4)"));
    CHECK(said.has("use a smaller --batch"));
    return said;
  };
  fails(1, train + "--save first --iterations 3");
  const Said early = fails(200, train + "--save early --iterations 3");
  CHECK(early.has("the run stopped after iteration 0; no checkpoint was written to early yet"));
  REQUIRE(call(train + "--save run --iterations 2").status == 0);
  const std::string resume = "train dvgan --resume --save run --iterations 3";
  fails(2, resume);
  const Said late = fails(200, resume);
  CHECK(late.has("the run stopped after iteration 2; the last checkpoint in run is kept"));
  CHECK(late.has("train dvgan --resume --save run"));
  CHECK(call(resume).status == 0);
  CHECK(bytes_of("run/checkpoint.safetensors") == bytes_of("whole/checkpoint.safetensors"));
}

}  // namespace devices_test
