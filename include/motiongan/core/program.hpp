// Compiling the embedded kernel files for one device, and finding kernels in them by name.
#pragma once
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "motiongan/core/device.hpp"
#include "motiongan/generated/kernels.hpp"

namespace motiongan {

/// The arithmetic of a Context: float for training and sampling, double for checks of derivatives.
enum class Precision { f32, f64 };

namespace detail {

/// The text of cl/<name>.cl.
inline const char* kernel_file(std::string_view name) {
  if (name == "elementwise") return kernels::elementwise;
  if (name == "reduce") return kernels::reduce;
  if (name == "layout") return kernels::layout;
  if (name == "gemm") return kernels::gemm;
  if (name == "gemm_packed") return kernels::gemm_packed;
  if (name == "softmax") return kernels::softmax;
  if (name == "lstm") return kernels::lstm;
  if (name == "gru") return kernels::gru;
  if (name == "random") return kernels::random;
  if (name == "adam") return kernels::adam;
  if (name == "sgd") return kernels::sgd;
  if (name == "search") return kernels::search;
  throw Error("there is no kernel file cl/", name, ".cl");
}

/// What stands between prelude.cl and cl/<name>.cl; empty for most.
inline const char* shared_part(std::string_view name) {
  return name.starts_with("gemm") ? kernels::gemm_tiles : "";
}

/// Programs and kernels of one context, built when first asked for and kept.
class ProgramCache {
 public:
  ProgramCache(cl_context context, const Device& device, Precision precision)
      : context_(context), device_(device), precision_(precision) {}

  /// Numbers of the context's type that one vector register of a CPU holds (4 on other devices).
  unsigned vector_width() const {
    unsigned width = device_.is_cpu() ? device_.native_float_width : 4;
    width = width >= 16 ? 16 : width >= 8 ? 8 : 4;
    return precision_ == Precision::f64 && width > 4 ? width / 2 : width;
  }

  cl_kernel kernel(const char* file, const char* name) {
    std::string& key = key_;  // reused, so that a look-up allocates nothing
    key.assign(file).append(1, '/').append(name);
    if (const auto found = kernels_.find(key); found != kernels_.end()) return found->second.get();
    cl_int code = CL_SUCCESS;
    ClKernel kernel(clCreateKernel(program(file), name, &code));
    check_cl(code, "clCreateKernel", ": kernel ", name, " of cl/", file, ".cl");
    return kernels_.emplace(key, std::move(kernel)).first->second.get();
  }

 private:
  cl_program program(const std::string& file) {
    if (const auto found = programs_.find(file); found != programs_.end()) return found->second.get();
    // The #line directives make the compiler name the real files in its messages.
    const std::string text =
        concat("#line 1 \"prelude.cl\"\n", kernels::prelude, "\n#line 1 \"gemm_tiles.cl\"\n",
               shared_part(file), "\n#line 1 \"", file, ".cl\"\n", kernel_file(file));
    const char* source = text.c_str();
    cl_int code = CL_SUCCESS;
    ClProgram program(clCreateProgramWithSource(context_, 1, &source, nullptr, &code));
    check_cl(code, "clCreateProgramWithSource", ": cl/", file, ".cl");
    const std::string options =
        concat("-cl-std=CL1.2 -DREAL=", precision_ == Precision::f64 ? "double" : "float",
               precision_ == Precision::f64 ? " -DREAL_IS_DOUBLE" : "", " -DVW=", vector_width(),
               device_.is_cpu() ? " -DDEVICE_IS_CPU" : "");
    code = clBuildProgram(program.get(), 1, &device_.id, options.c_str(), nullptr, nullptr);
    if (code != CL_SUCCESS) {
      std::size_t size = 0;
      clGetProgramBuildInfo(program.get(), device_.id, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
      std::string log(size, '\0');
      clGetProgramBuildInfo(program.get(), device_.id, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
      throw Error("clBuildProgram failed with ", opencl_error_name(code), " for cl/", file, ".cl on ",
                  device_.name, " (options ", options, "):\n", log);
    }
    return programs_.emplace(file, std::move(program)).first->second.get();
  }

  cl_context context_;
  Device device_;
  Precision precision_;
  std::string key_;
  std::unordered_map<std::string, ClProgram> programs_;
  std::unordered_map<std::string, ClKernel> kernels_;
};

}  // namespace detail
}  // namespace motiongan
