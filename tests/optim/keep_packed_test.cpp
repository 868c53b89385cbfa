// Packed weights are used again while they do not change, and only then.
#include <doctest/doctest.h>

#include <motiongan/autograd/grad.hpp>
#include <motiongan/core/random.hpp>
#include <motiongan/ops/conv1d.hpp>
#include <motiongan/ops/elementwise.hpp>
#include <motiongan/optim/sgd.hpp>

namespace keep_packed_test {

using namespace motiongan;

namespace {

struct Layer {
  Context context;
  Tensor x = random_normal(context, {.seed = 1}, 8, 64, 96);
  Var w = Var::leaf(random_normal(context, {.seed = 2}, 3, 96, 96));
  Sgd optimizer{{{"w", &w}}, SgdOptions{.learning_rate = 0.1}};

  std::vector<float> forward() const {
    return conv1d(Var::constant(x), w, {-1, 0, 1}, 8).value().to_host<float>();
  }
  std::size_t launches(const std::function<void()>& work) const {
    const std::size_t before = context.statistics().launches;
    work();
    return context.statistics().launches - before;
  }
};

TEST_CASE("weights are packed once until the optimizer steps") {
  Layer layer;
  const std::vector<float> fresh = layer.forward();
  const std::size_t alone = layer.launches([&] { layer.forward(); });
  const KeepPacked kept;
  CHECK(layer.launches([&] { layer.forward(); }) == alone);
  if (detail::packs_weights(layer.context)) CHECK(layer.launches([&] { layer.forward(); }) == alone - 1);
  CHECK(layer.forward() == fresh);
  layer.optimizer.step({Var::constant(full(layer.context, {3, 96, 96}, 1))});
  CHECK(layer.launches([&] { layer.forward(); }) == alone);
  const std::vector<float> moved = layer.forward();
  CHECK(moved != fresh);
  // The same weights, never packed before.
  const Tensor same = Tensor::from(layer.context, {3, 96, 96}, layer.w.value().to_host<float>());
  CHECK(conv1d(Var::constant(layer.x), Var::constant(same), {-1, 0, 1}, 8).value().to_host<float>() == moved);
}

TEST_CASE("computed weights are forgotten after two steps of an optimizer") {
  Layer layer;
  const KeepPacked kept;
  const auto size = [] { return detail::PackedTensors::current()->size(); };
  conv1d(Var::constant(layer.x), 2 * layer.w, {-1, 0, 1}, 8);
  if (size() == 0) {
    MESSAGE("skipped: nothing is packed on this device");
    return;
  }
  const Var gradient = Var::constant(full(layer.context, {3, 96, 96}, 0));
  layer.optimizer.step({gradient});
  CHECK(size() == 1);
  layer.optimizer.step({gradient});
  CHECK(size() == 0);
}

TEST_CASE("an inner scope uses the outer one's") {
  CHECK(detail::PackedTensors::current() == nullptr);
  {
    const KeepPacked outer;
    const detail::PackedTensors* tensors = detail::PackedTensors::current();
    {
      const KeepPacked inner;
      CHECK(detail::PackedTensors::current() == tensors);
    }
    CHECK(detail::PackedTensors::current() == tensors);
  }
  CHECK(detail::PackedTensors::current() == nullptr);
}

}  // namespace

}  // namespace keep_packed_test
