// The narrow and the wide form of the kernels: which a device gets, what they ask of it, any size of group.
#include <doctest/doctest.h>

#include <motiongan/generated/kernels.hpp>
#include <motiongan/ops/reduce.hpp>
#include <regex>
#include <set>

#include "../support/messages.hpp"
#include "../support/setting.hpp"
#include "gemm_problem.hpp"

namespace kernel_form_test {

using namespace motiongan;
using namespace motiongan::testing;

namespace {

Device device_of(cl_device_type type, std::size_t max_group = 1024) {
  Device device;
  device.type = type;
  device.max_group = max_group;
  return device;
}

/// The names of the kernels in a file and what it includes.
std::set<std::string> kernels_of(const char* file) {
  static const std::regex pattern("kernel void (\\w+)\\(");
  const std::string source = detail::kernel_source(file);
  std::set<std::string> names;
  for (std::sregex_iterator i(source.begin(), source.end(), pattern), end; i != end; ++i)
    names.insert((*i)[1]);
  names.erase("name");  // of the macros in elementwise.cl
  return names;
}

template <class T>
T ask(cl_kernel kernel, cl_device_id device, cl_kernel_work_group_info what) {
  T value{};
  REQUIRE(clGetKernelWorkGroupInfo(kernel, device, what, sizeof value, &value, nullptr) == CL_SUCCESS);
  return value;
}

}  // namespace

TEST_CASE("narrow for CPU devices, wide for all others, unless MOTIONGAN_KERNELS names one") {
  {
    const Setting setting("MOTIONGAN_KERNELS", "");
    CHECK(kernel_form(device_of(CL_DEVICE_TYPE_CPU)) == KernelForm::narrow);
    CHECK(kernel_form(device_of(CL_DEVICE_TYPE_GPU)) == KernelForm::wide);
    Device llvmpipe = device_of(CL_DEVICE_TYPE_CPU);
    llvmpipe.platform_name = "rusticl";
    CHECK(kernel_form(llvmpipe) == KernelForm::wide);
    CHECK(kernel_form(device_of(CL_DEVICE_TYPE_ACCELERATOR)) == KernelForm::wide);
    const Context context;
    CHECK(context.wide() == (kernel_form(context.device()) == KernelForm::wide));
    CHECK(context.counting().wide() == context.wide());
  }
  for (const bool wide : {false, true}) {
    const Setting setting("MOTIONGAN_KERNELS", wide ? "wide" : "narrow");
    for (const cl_device_type type : {CL_DEVICE_TYPE_CPU, CL_DEVICE_TYPE_GPU})
      CHECK((kernel_form(device_of(type)) == KernelForm::wide) == wide);
    const Context context;
    CHECK(context.wide() == wide);
    if (wide) CHECK(context.vector_width() == 4);
    if (wide) CHECK_FALSE(context.for_cpu());
    const Setting later("MOTIONGAN_KERNELS", wide ? "narrow" : "wide");  // read when a context is made
    CHECK(context.wide() == wide);
    CHECK(context.counting().wide() == wide);
    CHECK(Context().wide() == !wide);
  }
  const Setting setting("MOTIONGAN_KERNELS", "broad");
  CHECK(message_of([] { Context(); }) ==
        "MOTIONGAN_KERNELS is \"broad\", expected narrow or wide; or leave it unset");
}

TEST_CASE("the size of a group is a power of two that the device allows") {
  const auto size = [](std::size_t max_group, std::size_t limit = 0) {
    return detail::group_size(device_of(CL_DEVICE_TYPE_GPU, max_group), limit);
  };
  CHECK(size(1024) == 64);
  CHECK(size(64) == 64);
  CHECK(size(63) == 32);
  CHECK(size(1) == 1);
  CHECK(size(0) == 1);
  CHECK(size(1024, 16) == 16);
  CHECK(size(8, 16) == 8);
}

TEST_CASE("no kernel asks more than OpenCL 1.2 guarantees, or larger groups than the device's") {
  constexpr cl_ulong guaranteed = 32 * 1024;  // bytes of local memory
  for (const Precision precision : {Precision::f32, Precision::f64})
    for (const KernelForm form : {KernelForm::narrow, KernelForm::wide}) {
      if (precision == Precision::f64 && !Context().device().has_double) continue;
      const Context context({.precision = precision});
      cl_context cl = nullptr;
      REQUIRE(clGetCommandQueueInfo(context.queue(), CL_QUEUE_CONTEXT, sizeof cl, &cl, nullptr) ==
              CL_SUCCESS);
      detail::Driver driver;
      detail::ProgramCache programs(cl, context.device(), {precision, form, context.group()}, driver);
      std::size_t count = 0;
      for (const auto& file : kernels::files) {
        const std::string name = file.name;
        if (form == KernelForm::narrow && name.ends_with("_wide")) continue;
        for (const std::string& kernel : kernels_of(file.name)) {
          CAPTURE(name);
          CAPTURE(kernel);
          const cl_kernel built = programs.kernel(file.name, kernel.c_str());
          const cl_device_id id = context.device().id;
          CHECK(ask<cl_ulong>(built, id, CL_KERNEL_LOCAL_MEM_SIZE) <= guaranteed);
          CHECK(ask<std::size_t>(built, id, CL_KERNEL_WORK_GROUP_SIZE) >= context.group());
          const auto fixed = ask<std::array<std::size_t, 3>>(built, id, CL_KERNEL_COMPILE_WORK_GROUP_SIZE);
          CHECK(fixed[0] <= context.group());
          CHECK(fixed[1] <= 1);
          CHECK(fixed[2] <= 1);
          ++count;
        }
      }
      CHECK(count >= 55);
    }
}

TEST_CASE("rows and products in groups of every size") {
  const Setting setting("MOTIONGAN_KERNELS", "wide");
  constexpr std::size_t rows = 5, length = 131;
  std::mt19937 random(1);
  const std::vector<double> values = test::random_values(random, rows * length, Precision::f32);
  std::vector<double> product;
  for (const std::size_t limit : {1u, 2u, 4u, 8u, 16u, 32u, 64u}) {
    const Context context({.group_limit = limit});
    CAPTURE(limit);
    CHECK(context.group() <= limit);
    const Var x = Var::constant(Tensor::from(context, {rows, length}, values));
    const std::vector<double> shares = softmax(x).value().to_host<double>(),
                              logarithms = log_softmax(x).value().to_host<double>(),
                              sums = sum(x, -1).value().to_host<double>();
    for (std::size_t r = 0; r < rows; ++r) {
      double total = 0, whole = 0;
      for (std::size_t j = 0; j < length; ++j)
        total += values[r * length + j], whole += std::exp(values[r * length + j]);
      CHECK(std::abs(sums[r] - total) < 1e-5);
      for (std::size_t j = 0; j < length; ++j) {
        const double share = std::exp(values[r * length + j]) / whole;
        CHECK(shares[r * length + j] == doctest::Approx(share).epsilon(1e-5));
        CHECK(std::abs(logarithms[r * length + j] - std::log(share)) < 1e-5);
      }
    }
    for (const std::size_t m : {3u, 70u}) {  // each of the two kernels
      std::mt19937 same(m);
      const test::Problem problem = test::make(context, {.m = m, .n = 37, .k = 45, .segments = 2}, same);
      gemm(context, problem.call, GemmEngine::native);
      const std::vector<double> c = problem.call.c.to_host<double>(), expected = test::expected(problem);
      for (std::size_t e = 0; e < c.size(); ++e) CHECK(std::abs(c[e] - expected[e]) < 1e-5);
      if (m == 70u) continue;
      if (product.empty()) product = c;
      CHECK(c == product);  // whatever the group
    }
  }
}

TEST_CASE("a row alone has the bits of the row among others, in either form") {
  for (const char* form : {"narrow", "wide"}) {
    const Setting setting("MOTIONGAN_KERNELS", form);
    const Context context;
    std::mt19937 random(2);
    for (const std::size_t length : {3u, 31u, 32u, 100u, 4097u, 10001u}) {
      CAPTURE(length);
      constexpr std::size_t rows = 4;
      const std::vector<double> values = test::random_values(random, rows * length, Precision::f32);
      const Tensor all = Tensor::from(context, {rows, length}, values);
      const auto same = [&](const auto& function, std::size_t width) {
        const std::vector<float> together = function(Var::constant(all)).value().to_host();
        for (std::size_t r = 0; r < rows; ++r) {
          const std::vector<float> alone =
              function(Var::constant(all.view(r * length, {1, length}))).value().to_host();
          CHECK(std::equal(alone.begin(), alone.end(),
                           together.begin() + static_cast<std::ptrdiff_t>(r * width)));
        }
        return together;
      };
      same([](const Var& x) { return softmax(x); }, length);
      same([](const Var& x) { return log_softmax(x); }, length);
      const std::vector<float> sums = same([](const Var& x) { return sum(x, -1); }, 1);
      for (std::size_t r = 0; r < rows; ++r) {
        double total = 0;
        for (std::size_t j = 0; j < length; ++j) total += values[r * length + j];
        CHECK(std::abs(static_cast<double>(sums[r]) - total) < 1e-4);
      }
    }
  }
}

}  // namespace kernel_form_test
