// Context: buffer pool, memory limit, environment variables, errors.
#include <doctest/doctest.h>

#include <motiongan/core/gemm.hpp>
#include <motiongan/ops/elementwise.hpp>

#include "../support/messages.hpp"
#include "../support/setting.hpp"

namespace context_test {

using namespace motiongan;
using namespace motiongan::testing;

TEST_CASE("a released buffer is reused") {
  const Context context;
  const auto& now = context.statistics();
  for (int i = 0; i < 3; ++i) const Tensor a(context, {100, 10}), b(context, {7});
  CHECK(now.allocations == 2);
  CHECK(now.bytes_in_use == 0);
  CHECK(now.bytes_cached >= 4028);

  {
    const Tensor a(context, {100, 10});
    CHECK(now.bytes_in_use >= 4000);
    const Tensor same = a, piece = a.view(10, {5});  // they share its buffer
    CHECK(now.allocations == 2);
    const Tensor second(context, {100, 10});  // the first is in use
    CHECK(now.allocations == 3);
    CHECK(second.buffer() != a.buffer());
  }
  { const Tensor a_little_smaller(context, {990}); }
  CHECK(now.allocations == 3);
  { const Tensor much_smaller(context, {300}); }  // too small to reuse the large one
  CHECK(now.allocations == 4);
  CHECK(now.peak_bytes == now.bytes_cached);

  context.trim();
  CHECK(now.bytes_cached == 0);
  { const Tensor a(context, {100, 10}); }
  CHECK(now.allocations == 5);
}

TEST_CASE("a view keeps the buffer after its tensor is gone") {
  const Context context;
  Tensor piece;
  {
    const Tensor whole = Tensor::from(context, {6}, std::vector<float>{1, 2, 3, 4, 5, 6});
    piece = whole.view(2, {3});
  }
  const Tensor other = full(context, {6}, 9);
  CHECK(piece.to_host() == std::vector<float>{3, 4, 5});
}

TEST_CASE("the memory limit holds, and the error states request, use and limit") {
  const Context context({.memory_limit = 1'000'000});
  const Tensor half(context, {125'000});  // 0.5 MB
  const std::string text = message_of([&] { Tensor(context, {150'000}); });
  CHECK(says(text, "out of device memory: 0.6 MB requested"));
  CHECK(says(text, "0.504 MB already in use, limit 1 MB"));
  CHECK(says(text, "MOTIONGAN_MEMORY_MB"));
  CHECK(context.statistics().bytes_in_use < 510'000);  // nothing leaked, and allocations that fit still work
  { const Tensor more(context, {110'000}); }
  // Now 0.44 MB are cached; they are freed for a request of another size.
  const Tensor other(context, {60'000});
  CHECK(context.statistics().bytes_in_use + context.statistics().bytes_cached <= 1'000'000);
}

TEST_CASE("one allocation larger than the device allows") {
  const Context context({.memory_limit = std::size_t{1} << 60});
  for (const std::size_t bytes : {context.device().max_allocation + 4096, ~cl_ulong{0}}) {
    const std::string text = message_of([&] { context.allocate(bytes); });
    CHECK(says(text, "out of device memory: one buffer of"));
    CHECK(says(text, "in one allocation"));
  }
}

TEST_CASE("MOTIONGAN_MEMORY_MB") {
  {
    const Setting setting("MOTIONGAN_MEMORY_MB", "2");
    const Context context;
    CHECK_NOTHROW(Tensor(context, {400'000}));
    CHECK(says(message_of([&] { Tensor(context, {600'000}); }), "limit 2 MB"));
    const Context more({.memory_limit = 4'000'000});  // the option takes precedence
    CHECK_NOTHROW(Tensor(more, {600'000}));
  }
  for (const std::string garbage :
       {"", "0", "much", "12 GB", "-5", "1.5", "99999999999999999", "18446744073710"}) {
    const Setting setting("MOTIONGAN_MEMORY_MB", garbage.c_str());
    const std::string text = message_of([] { Context(); });
    CAPTURE(garbage);
    CHECK(says(text, concat("MOTIONGAN_MEMORY_MB is \"", garbage, "\"")));
  }
}

TEST_CASE("an unknown device is an error, by option and by variable") {
  CHECK(says(message_of([] { Context({.device = "no such device"}); }), "\"no such device\""));
  const Setting setting("MOTIONGAN_DEVICE", "nor this one");
  CHECK(says(message_of([] { Context(); }), "\"nor this one\""));
}

TEST_CASE("a context describes itself") {
  const Context context;
  CHECK(says(context.description(), context.device().name));
  CHECK(says(context.description(), "float"));
  CHECK(context.real_size() == 4);
  const Context copy = context, other;
  CHECK(copy == context);
  CHECK_FALSE(other == context);
}

TEST_CASE("errors of launches name kernel, file, sizes and shapes") {
  const Context context;
  const Tensor x = full(context, {3, 5}, 1), out(context, {3, 5});
  CHECK(says(message_of([&] { context.launch("nowhere", "fill", LaunchGrid::items(1), x); }),
             "there is no kernel file cl/nowhere.cl"));

  const std::string unknown =
      message_of([&] { context.launch("elementwise", "no_such_kernel", LaunchGrid::items(1), x); });
  CHECK(says(unknown, "kernel no_such_kernel of cl/elementwise.cl"));
  CHECK(says(unknown, "CL_INVALID_KERNEL_NAME"));

  const std::string extra = message_of([&] {
    context.launch("elementwise", "fill", LaunchGrid::items(15), x, std::size_t{15}, KernelReal{1},
                   KernelReal{2});
  });
  CHECK(says(extra, "argument 4 of kernel fill"));

  const std::size_t large = std::size_t{1} << 20;  // items in one work-group: more than any device supports
  const std::string grid = message_of([&] {
    context.launch("elementwise", "affine", LaunchGrid{1, {large, 1, 1}, {large, 1, 1}}, x, out, x.size(),
                   KernelReal{2.5}, KernelReal{0});
  });
  CHECK(says(grid, "clEnqueueNDRangeKernel failed with CL_INVALID_WORK"));
  CHECK(says(grid, "kernel affine of cl/elementwise.cl"));
  CHECK(says(grid, "global size 1048576x1x1, local size 1048576"));
  CHECK(says(grid, "arguments [3, 5] [3, 5] 15 2.5 0"));

  CHECK(says(message_of([&] {
               context.launch("elementwise", "fill", LaunchGrid::items(1), x, std::size_t{1} << 33,
                              KernelReal{0});
             }),
             "kernel fill: 8589934592 does not fit 32 bits"));
  CHECK(says(message_of([&] {
               context.launch("elementwise", "fill", LaunchGrid::items(std::size_t{1} << 32), x,
                              std::size_t{15}, KernelReal{0});
             }),
             "kernel fill: 4294967296 work-items do not fit 32 bits"));

  // The context still works after the errors.
  CHECK(affine(Var::constant(x), 2).value().to_host() == std::vector<float>(15, 2));
}

TEST_CASE("an empty grid launches nothing") {
  const Context context;
  const std::size_t before = context.statistics().launches;
  context.launch("elementwise", "fill", LaunchGrid::items(0), Tensor(context, {1}), std::size_t{0},
                 KernelReal{0});
  CHECK(context.statistics().launches == before);
}

TEST_CASE("statistics count launches, reads and writes") {
  const Context context;
  const auto& now = context.statistics();
  const Tensor x = Tensor::from(context, {2}, std::vector<float>{1, 2});
  CHECK(now.writes == 1);
  const Var y = affine(Var::constant(x), 3);
  CHECK(now.launches == 1);
  CHECK(now.reads == 0);
  CHECK(y.value().to_host() == std::vector<float>{3, 6});
  CHECK(now.reads == 1);
}

TEST_CASE("the host memory kept for uploads has a limit, and uploads arrive whole") {
  const Context context;
  const auto& now = context.statistics();
  const std::size_t million = 1'000'000;
  std::vector<Tensor> tensors;
  for (int i = 0; i < 20; ++i) {  // 80 MB
    tensors.push_back(Tensor::from(context, {million}, std::vector<float>(million, static_cast<float>(i))));
    CHECK(now.bytes_staged <= detail::Staging::limit);
  }
  CHECK(now.bytes_staged > detail::Staging::limit / 2);
  for (std::size_t i = 0; i < tensors.size(); ++i) {
    const std::vector<float> values = tensors[i].to_host();
    CHECK(std::all_of(values.begin(), values.end(), [&](float v) { return v == static_cast<float>(i); }));
  }
  const std::size_t before = now.bytes_staged, many = detail::Staging::limit / 4 + 1;
  const Tensor large = Tensor::from(context, {many}, std::vector<float>(many, 3));  // not kept at all
  CHECK(now.bytes_staged == before);
  CHECK(large.to_host() == std::vector<float>(many, 3));
  for (int i = 0; i < 200; ++i) Tensor::from(context, {10}, std::vector<float>(10, 1));
  CHECK(now.bytes_staged < 64 * 1024);  // small uploads replace the large ones' memory
}

TEST_CASE("statistics count the bytes of the arguments, in a context that only counts too") {
  const Context real;
  for (const Context& context : {real, real.counting()}) {
    const double& bytes = context.statistics().bytes_touched;
    const Tensor x(context, {10, 3}), out(context, {10, 3}), b(context, {3, 7}), c(context, {10, 7});
    const auto added = [&](const auto& work) {
      const double before = bytes;
      work();
      return bytes - before;
    };
    const auto affine = [&](const auto& from, const auto& to, std::size_t n) {
      return added([&] {
        context.launch("elementwise", "affine", LaunchGrid::items(n), from, to, n, KernelReal{1},
                       KernelReal{0});
      });
    };
    CHECK(affine(x, out, 30) == 2 * 30 * 4);
    CHECK(affine(x.view(6, {3}), out, 3) == (3 + 30) * 4);
    CHECK(affine(detail::At{x, 6, 3}, detail::At{out, 20}, 3) == (3 + 10) * 4);
    CHECK(affine(x, out, 0) == 0);
    GemmCall call{.m = 10, .n = 7, .k = 3, .a = x, .b = b, .c = c, .a_ld = 3, .b_ld = 7, .c_ld = 7};
    const auto product = [&] { return added([&] { gemm(context, call); }); };
    CHECK(product() == (30 + 21 + 70) * 4);
    call.accumulate = true, call.bias = b.view(0, {7});
    CHECK(product() == (30 + 21 + 2 * 70 + 7) * 4);
    call.m = 0;
    CHECK(product() == 0);
  }
}

}  // namespace context_test
