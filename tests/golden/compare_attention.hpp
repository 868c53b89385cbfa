// The attention models on golden files.
#pragma once
#include <motiongan/networks/attention_classifier.hpp>
#include <motiongan/networks/attention_critic.hpp>
#include <motiongan/networks/attention_generator.hpp>
#include <motiongan/networks/lstm_baseline.hpp>
#include <motiongan/ops/cross_entropy.hpp>

#include "file.hpp"

namespace motiongan::golden::detail {

inline void attention_generator(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  AttentionGenerator model(
      Initializer(context, 1),
      {.dof = file.number("dof"), .classes = file.number("classes"), .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const Var classes = Var::constant(file.tensor(context, "in.class"));
  const Var future = model(Var::constant(file.tensor(context, "in.prior")), classes),
            after = model(future, classes);
  outputs.push_back(output(file, "out.future", future));
  outputs.push_back(output(file, "out.future2", after));
  add_gradients(gradients, file, parameters, grad(mean(square(after)), values_of(parameters)));
}

inline void attention_critic(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  AttentionCritic model(Initializer(context, 1),
                        {.dof = file.number("dof"), .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const CriticFn judge = [&](const Var& x) { return model(x); };
  add_critic(file, parameters, judge, judge, outputs, gradients);
}

inline void attention_classifier(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  AttentionClassifier model(
      Initializer(context, 1),
      {.dof = file.number("dof"), .classes = file.number("classes"), .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  std::vector<std::size_t> labels;
  for (const std::int64_t label : file.integers("in.label"))
    labels.push_back(static_cast<std::size_t>(label));
  const Var logits = model(Var::constant(file.tensor(context, "in.future")));
  outputs.push_back(output(file, "out.logits", logits));
  const Var loss = cross_entropy(logits, Var::constant(one_hot(context, labels, file.number("classes"))));
  add_gradients(gradients, file, parameters, grad(loss, values_of(parameters)));
}

inline void lstm_baseline(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  LstmBaseline model(
      Initializer(context, 1),
      {.dof = file.number("dof"), .classes = file.number("classes"), .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const Var target = Var::constant(file.tensor(context, "in.future"));
  const Var made = model(Var::constant(file.tensor(context, "in.prior")),
                         Var::constant(file.tensor(context, "in.class")), target.dim(0));
  outputs.push_back(output(file, "out.future", made));
  add_gradients(gradients, file, parameters, grad(mean(square(made - target)), values_of(parameters)));
}

}  // namespace motiongan::golden::detail
