// A kernel file that does not compile: the error carries the compiler's log and the file's name.
#include <motiongan/generated/kernels.hpp>

namespace motiongan::kernels {
inline constexpr char broken[] = "\nkernel void softmax_rows(global real* x) {\n  x[0] = no_such_name;\n}\n";
inline constexpr File broken_files[] = {{"prelude", prelude}, {"elementwise", elementwise}, {"rows", broken}};
}  // namespace motiongan::kernels

#define files broken_files  // replaces cl/rows.cl by the text above, in this program only
#include <motiongan/core/program.hpp>
#undef files

#include <doctest/doctest.h>

#include <motiongan/core/tensor.hpp>

using namespace motiongan;

TEST_CASE("the error of a failed build contains the log and the file") {
  const Context context;
  const Tensor x(context, {4});
  std::string text = "no error";
  try {
    context.launch("rows", "softmax_rows", LaunchGrid::items(4), x);
  } catch (const Error& error) {
    text = error.what();
  }
  CAPTURE(text);
  for (const char* part : {"clBuildProgram failed with CL_BUILD_PROGRAM_FAILURE", "for cl/rows.cl on ",
                           context.device().name.c_str(), "-DREAL=float", "rows.cl:3", "no_such_name"})
    CHECK(text.find(part) != std::string::npos);
  // Other files still build.
  CHECK_NOTHROW(context.launch("elementwise", "fill", LaunchGrid::items(4), x, x.size(), KernelReal{2}));
  CHECK(x.to_host() == std::vector<float>(4, 2));
}
