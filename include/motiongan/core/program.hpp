// Compiles the embedded kernel files for a device and looks kernels up by name.
#pragma once
#include <algorithm>
#include <iterator>
#include <map>
#include <string>
#include <string_view>
#include <unordered_map>

#include "motiongan/core/driver.hpp"
#include "motiongan/core/kernel_cache.hpp"
#include "motiongan/core/kernel_form.hpp"
#include "motiongan/generated/kernels.hpp"

namespace motiongan {

/// A kernel that computes an expression of every element: of v and, with two inputs, of w; a and b are
/// numbers of the launch. It is defined as an `inline const` object beside the operation that needs it, and
/// compiled with cl/elementwise.cl.
class ElementwiseKernel {
 public:
  /// `expression` is OpenCL C over the inputs v and w and the numbers a and b.
  ElementwiseKernel(const char* name, int inputs, const char* expression) : name_(name) {
    all()[name] = concat(inputs == 1 ? "UNARY(" : "BINARY(", name, ", ", expression, ")\n");
  }
  const char* name() const { return name_; }

  /// The source lines of all kernels, in the order of their names.
  static std::map<std::string, std::string>& all() {
    static std::map<std::string, std::string> lines;
    return lines;
  }

 private:
  const char* name_;
};

namespace detail {

/// The source of cl/<name>.cl with its includes expanded; #line directives keep the file names and line
/// numbers of compiler messages right. Throws Error if there is no such file.
inline std::string kernel_source(std::string_view name) {
  const auto found = std::find_if(std::begin(kernels::files), std::end(kernels::files),
                                  [&](const kernels::File& file) { return name == file.name; });
  require(found != std::end(kernels::files), "there is no kernel file cl/", name, ".cl");
  std::string out = concat("#line 1 \"", name, ".cl\"\n");
  std::string_view rest = found->text;
  constexpr std::string_view directive = "#include \"", extension = ".cl\"";
  for (std::size_t line = 1; !rest.empty(); ++line) {
    const std::string_view text = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(rest.size(), text.size() + 1));
    if (text.starts_with(directive) && text.ends_with(extension)) {
      const std::size_t length = text.size() - directive.size() - extension.size();
      out += kernel_source(text.substr(directive.size(), length));
      out += concat("#line ", line + 1, " \"", name, ".cl\"\n");
    } else {
      out.append(text) += '\n';
    }
  }
  return out;
}

/// Programs and kernels of one context, built on first use and cached.
class ProgramCache {
 public:
  ProgramCache(cl_context context, const Device& device, const KernelTarget& target, Driver& driver)
      : context_(context), device_(device), target_(target), driver_(driver), kept_(device) {}

  /// Whether the kernels are compiled for a CPU's caches and vector registers (FOR_CPU): not in the wide
  /// form, in which a CPU runs what other devices run.
  bool for_cpu() const { return device_.is_cpu() && !target_.wide(); }

  /// Elements per vector (VW in the kernels): 4, 8 or 16 for a CPU, by its vector registers, else 4.
  unsigned vector_width() const {
    unsigned width = for_cpu() ? device_.native_float_width : 4;
    width = width >= 16 ? 16 : width >= 8 ? 8 : 4;
    return target_.precision == Precision::f64 && width > 4 ? width / 2 : width;
  }

  /// Kernel `name` of cl/<file>.cl. Throws DeviceError, with the build log, if the file does not compile.
  cl_kernel kernel(const char* file, const char* name) {
    std::string& key = key_;  // reused, so that lookups do not allocate
    key.assign(file).append(1, '/').append(name);
    if (const auto found = kernels_.find(key); found != kernels_.end()) return found->second.get();
    cl_int code = CL_SUCCESS;
    ClKernel kernel(clCreateKernel(program(file), name, &code));
    driver_.check(code, "clCreateKernel", ": kernel ", name, " of cl/", file, ".cl");
    return kernels_.emplace(key, std::move(kernel)).first->second.get();
  }

 private:
  cl_program program(const std::string& file) {
    if (const auto found = programs_.find(file); found != programs_.end()) return found->second.get();
    std::string text = kernel_source("prelude") + kernel_source(file);
    if (file == "elementwise")
      for (const auto& [name, line] : ElementwiseKernel::all()) text += line;
    return programs_.emplace(file, build(file, text.c_str())).first->second.get();
  }

  ClProgram build(const std::string& file, const char* source) {
    if (!kept_) return compiled(file, source);
    if (ClProgram program = from_binary(kept_.find(options(""), source))) return program;
    ClProgram program = compiled(file, source);
    if (const std::string binary = binary_of(program.get()); !binary.empty())
      kept_.keep(options(""), source, binary);
    return program;
  }

  /// A null program if the driver does not take the binary.
  ClProgram from_binary(const std::string& binary) const {
    if (binary.empty()) return {};
    cl_int loaded = CL_SUCCESS, code = CL_SUCCESS;
    const std::size_t size = binary.size();
    const auto* bytes = reinterpret_cast<const unsigned char*>(binary.data());
    ClProgram program(clCreateProgramWithBinary(context_, 1, &device_.id, &size, &bytes, &loaded, &code));
    if (code != CL_SUCCESS || loaded != CL_SUCCESS) return {};
    if (clBuildProgram(program.get(), 1, &device_.id, "", nullptr, nullptr) != CL_SUCCESS) return {};
    return program;
  }

  /// Empty if the driver does not give it.
  static std::string binary_of(cl_program program) {
    std::size_t size = 0;  // of the one device's
    if (clGetProgramInfo(program, CL_PROGRAM_BINARY_SIZES, sizeof size, &size, nullptr) != CL_SUCCESS)
      return {};
    std::string binary(size, '\0');
    auto* bytes = reinterpret_cast<unsigned char*>(binary.data());
    if (clGetProgramInfo(program, CL_PROGRAM_BINARIES, sizeof bytes, &bytes, nullptr) != CL_SUCCESS)
      return {};
    return binary;
  }

  ClProgram compiled(const std::string& file, const char* source) {
    cl_int code = CL_SUCCESS;
    ClProgram program(clCreateProgramWithSource(context_, 1, &source, nullptr, &code));
    driver_.check(code, "clCreateProgramWithSource", ": cl/", file, ".cl");
    code = compile(program.get(), standard_);
    if (code == CL_SUCCESS) return program;
    const std::string log = build_log(program.get());
    // Some drivers refuse the option for the language version, and compile 1.2 or later without it.
    const bool refused = code == CL_INVALID_BUILD_OPTIONS || code == CL_INVALID_COMPILER_OPTIONS ||
                         code == CL_BUILD_PROGRAM_FAILURE || code == CL_COMPILE_PROGRAM_FAILURE;
    const bool tries_again = refused && *standard_ != '\0';
    if (tries_again && compile(program.get(), "") == CL_SUCCESS) {
      standard_ = "";
      return program;
    }
    const std::string reported = driver_.messages.take();
    throw DeviceError("clBuildProgram failed with ", opencl_error_name(code), " for cl/", file, ".cl on ",
                      device_.name, " (options ", options(standard_),
                      tries_again ? ", and without the first" : "", "):\n", log,
                      reported.empty() ? "" : "\nthe driver reports: ", reported, build_advice(code, log));
  }

  std::string options(const char* standard) const {
    const bool twofold = target_.precision == Precision::f64;
    return concat(standard, "-DREAL=", twofold ? "double" : "float", twofold ? " -DREAL_IS_DOUBLE" : "",
                  " -DVW=", vector_width(), for_cpu() ? " -DFOR_CPU" : "",
                  can_prefetch() ? " -DCAN_PREFETCH" : "",
                  target_.wide() ? concat(" -DWIDE -DGROUP=", target_.group) : "");
  }

  /// Whether the compiler knows __builtin_prefetch: others abort the process, such as Mesa's.
  bool can_prefetch() const {
    return for_cpu() && (is_pocl(device_.platform_name) || device_.platform_name == "Intel(R) OpenCL");
  }

  cl_int compile(cl_program program, const char* standard) const {
    return clBuildProgram(program, 1, &device_.id, options(standard).c_str(), nullptr, nullptr);
  }

  std::string build_log(cl_program program) const {
    std::size_t size = 0;
    clGetProgramBuildInfo(program, device_.id, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
    std::string log(size, '\0');
    clGetProgramBuildInfo(program, device_.id, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
    while (!log.empty() && (log.back() == '\0' || log.back() == '\n')) log.pop_back();
    return log;
  }

  /// A compiler that found no error may lack memory or, as PoCL does not say, a cache that it can write to.
  std::string build_advice(cl_int code, const std::string& log) const {
    if (log.find("error:") != std::string::npos) return {};
    return concat(opencl_advice(code), is_pocl(device_.platform_name) ? concat("\n", pocl_cache_advice) : "");
  }

  cl_context context_;
  Device device_;
  KernelTarget target_;
  Driver& driver_;
  KernelCache kept_;
  const char* standard_ = "-cl-std=CL1.2 ";
  std::string key_;
  std::unordered_map<std::string, ClProgram> programs_;
  std::unordered_map<std::string, ClKernel> kernels_;
};

}  // namespace detail
}  // namespace motiongan
