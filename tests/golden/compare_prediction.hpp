// The motion-completion baselines on golden files.
#pragma once
#include <motiongan/networks/erd.hpp>
#include <motiongan/networks/lstm_3lr.hpp>
#include <motiongan/networks/seq2seq.hpp>

#include "file.hpp"

namespace motiongan::golden::detail {

inline Var mean_square(const Var& a, const Var& b) { return mean(square(a - b)); }

inline void seq2seq(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  const std::size_t classes = file.number("classes");
  Seq2seq model(Initializer(context, 1),
                {.dof = file.number("dof"), .classes = classes, .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const Var target = Var::constant(file.tensor(context, "in.future"));
  const Var made =
      model(Var::constant(file.tensor(context, "in.prefix")),
            classes > 0 ? Var::constant(file.tensor(context, "in.class")) : Var(), target.dim(0));
  const Var loss = mean_square(made, target);
  outputs.push_back(output(file, "out.future", made));
  outputs.push_back(output(file, "out.loss", loss));
  add_gradients(gradients, file, parameters, grad(loss, values_of(parameters)));
}

/// A model that predicts the next pose and then runs on its own output.
template <class Model>
void next_pose_model(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  Model model(Initializer(context, 1), {.dof = file.number("dof"), .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const Var prefix = Var::constant(file.tensor(context, "in.prefix")),
            target = Var::constant(file.tensor(context, "in.future")),
            window = concatenate({prefix, target}, 0);
  const std::size_t count = window.dim(0) - 1;
  LstmState state;
  const Var next = model.next_poses(slice(window, 0, 0, count), state), made = model(prefix, target.dim(0));
  const Var loss = mean_square(next, slice(window, 0, 1, count)) + mean_square(made, target);
  outputs.push_back(output(file, "out.next", next));
  outputs.push_back(output(file, "out.future", made));
  outputs.push_back(output(file, "out.loss", loss));
  add_gradients(gradients, file, parameters, grad(loss, values_of(parameters)));
}

}  // namespace motiongan::golden::detail
