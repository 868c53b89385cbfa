// The peak arithmetic throughput of the device: fused multiply-adds per second on all its cores.
#pragma once
#include <algorithm>
#include <chrono>
#include <motiongan/core/context.hpp>
#include <string>

namespace motiongan::bench {

inline double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Measures it with independent chains of fma in vector registers.
class Peak {
 public:
  explicit Peak(const Context& context) : context_(context), sink_(context.allocate(groups * 64)) {
    // As many chains as fit the registers next to the two factors: 32 registers of 64 bytes, otherwise 16.
    const bool wide = context.vector_width() * context.real_size() == 64;
    chains_ = wide ? 20 : 12;
    const std::string real = context.precision() == Precision::f64 ? "double" : "float";
    const std::string vector = concat(real, context.vector_width());
    const std::string source = concat(
        "__attribute__((reqd_work_group_size(1, 1, 1))) kernel void peak(global ", real, "* out, uint n, ",
        real, " x) {\n  ", vector, " c[", chains_, "];\n  const ", vector, " a = x, b = x * (", real,
        ")0.5;\n#pragma unroll\n  for (int i = 0; i < ", chains_,
        "; i++) c[i] = x + i;\n  for (uint k = 0; k < n; k++) {\n#pragma unroll\n    for (int i = 0; i < ",
        chains_, "; i++) c[i] = fma(c[i], a, b);\n  }\n  ", vector, " s = 0;\n  for (int i = 0; i < ",
        chains_, "; i++) s += c[i];\n  vstore", context.vector_width(), "(s, get_global_id(0), out);\n}\n");
    const char* text = source.c_str();
    cl_context cl = nullptr;
    check_cl(clGetCommandQueueInfo(context.queue(), CL_QUEUE_CONTEXT, sizeof cl, &cl, nullptr),
             "clGetCommandQueueInfo");
    cl_int code = CL_SUCCESS;
    program_ = ClProgram(clCreateProgramWithSource(cl, 1, &text, nullptr, &code));
    check_cl(code, "clCreateProgramWithSource", ": peak");
    check_cl(clBuildProgram(program_.get(), 0, nullptr, "-cl-std=CL1.2", nullptr, nullptr), "clBuildProgram",
             ": peak\n", source);
    kernel_ = ClKernel(clCreateKernel(program_.get(), "peak", &code));
    check_cl(code, "clCreateKernel", ": peak");
  }

  /// GFLOP/s: the best of several runs of a few milliseconds each, including those of earlier calls.
  double measure() {
    run(1000);
    for (int i = 0; i < 15; ++i) best_ = std::max(best_, run(100'000));
    return best_;
  }

 private:
  static constexpr std::size_t groups = 16;

  double run(cl_uint steps) {
    const cl_mem sink = sink_->buffer();
    clSetKernelArg(kernel_.get(), 0, sizeof sink, &sink);
    clSetKernelArg(kernel_.get(), 1, sizeof steps, &steps);
    const double x64 = 0.5;
    const float x32 = 0.5f;
    if (context_.precision() == Precision::f64)
      clSetKernelArg(kernel_.get(), 2, sizeof x64, &x64);
    else
      clSetKernelArg(kernel_.get(), 2, sizeof x32, &x32);
    const std::size_t global = groups, local = 1;
    context_.finish();
    const double start = seconds();
    check_cl(clEnqueueNDRangeKernel(context_.queue(), kernel_.get(), 1, nullptr, &global, &local, 0, nullptr,
                                    nullptr),
             "clEnqueueNDRangeKernel", ": peak");
    context_.finish();
    const double flops = 2.0 * groups * steps * static_cast<double>(chains_ * context_.vector_width());
    return flops / (seconds() - start) / 1e9;
  }

  Context context_;
  std::shared_ptr<detail::Storage> sink_;
  unsigned chains_ = 0;
  double best_ = 0;
  ClProgram program_;
  ClKernel kernel_;
};

}  // namespace motiongan::bench
