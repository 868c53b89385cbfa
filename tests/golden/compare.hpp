// Runs a model on a golden file and compares the results.
#pragma once
#include <motiongan/networks/cnn_critic.hpp>
#include <motiongan/networks/cnn_generator.hpp>
#include <motiongan/networks/rnn_critic.hpp>
#include <motiongan/networks/rnn_generator.hpp>

#include "compare_attention.hpp"
#include "compare_prediction.hpp"
#include "compare_ranker.hpp"

namespace motiongan::golden {
namespace detail {

inline void cnn_generator(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  CnnGenerator model(Initializer(context, 1), {.vocabulary = file.number("vocab"),
                                               .dof = file.number("dof"),
                                               .frames = file.number("frames"),
                                               .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  std::vector<Var> z;
  for (std::size_t i = 0; i <= model.levels(); ++i)
    z.push_back(Var::constant(file.tensor(context, "in.z." + std::to_string(i))));
  const auto cut_values = file.integers("in.cut");
  const Indices cut(context, std::vector<cl_int>(cut_values.begin(), cut_values.end()));
  z.back() = model.cut_noise(z.back(), cut);
  const Var motion = model(file.sentences(context), z, cut);
  outputs.push_back(output(file, "out.motion", motion));
  add_gradients(gradients, file, parameters, grad(mean(square(motion)), values_of(parameters)));
}

inline void rnn_generator(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  RnnGenerator model(Initializer(context, 1), {.vocabulary = file.number("vocab"),
                                               .dof = file.number("dof"),
                                               .frames = file.number("frames"),
                                               .hidden = file.number("hidden")});
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const Sentences text = file.sentences(context);
  const Var z = Var::constant(file.tensor(context, "in.z"));
  const Var motion = model(text, z),
            completed = model(text, z, {}, Var::constant(file.tensor(context, "in.seed")));
  outputs.push_back(output(file, "out.motion", motion));
  outputs.push_back(output(file, "out.completed", completed));
  const Var loss = mean(square(motion)) + mean(square(completed));
  add_gradients(gradients, file, parameters, grad(loss, values_of(parameters)));
}

/// A critic of motion and text.
template <class Critic>
void critic(Critic model, const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const Var h_txt = model.encode_text(file.sentences(context)), both = concatenate({h_txt, h_txt}, 0);
  add_critic(
      file, parameters, [&](const Var& x) { return model(x, both); },
      [&](const Var& x) { return model(x, h_txt); }, outputs, gradients);
}

inline void cnn_critic(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  const std::string validate = file.text("validate");
  require(validate == "dense" || validate == "mod2" || validate == "final", file.where(), ": validate is \"",
          validate, "\", expected dense, mod2 or final");
  critic(CnnCritic(Initializer(context, 1), {.vocabulary = file.number("vocab"),
                                             .dof = file.number("dof"),
                                             .frames = file.number("frames"),
                                             .hidden = file.number("hidden"),
                                             .validation = validate == "dense"  ? Validation::dense
                                                           : validate == "mod2" ? Validation::mod2
                                                                                : Validation::final}),
         file, context, outputs, gradients);
}

inline void rnn_critic(const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  critic(RnnCritic(Initializer(context, 1), {.vocabulary = file.number("vocab"),
                                             .dof = file.number("dof"),
                                             .hidden = file.number("hidden")}),
         file, context, outputs, gradients);
}

}  // namespace detail

/// Compares one file, in the precision it was written in. Throws Error for an unknown model.
inline Report compare(const std::filesystem::path& path) {
  const File file(path);
  Report report;
  report.model = file.text("model");
  report.dtype = file.text("dtype");
  require(report.dtype == "f32" || report.dtype == "f64", file.where(), ": dtype is \"", report.dtype,
          "\", expected f32 or f64");
  const bool doubles = report.dtype == "f64";
  report.tolerance = doubles ? 1e-9 : 1e-4;
  const Context context({.precision = doubles ? Precision::f64 : Precision::f32});
  std::vector<Pair> outputs, gradients;
  if (report.model == "cnn_generator")
    detail::cnn_generator(file, context, outputs, gradients);
  else if (report.model == "rnn_generator")
    detail::rnn_generator(file, context, outputs, gradients);
  else if (report.model == "cnn_critic")
    detail::cnn_critic(file, context, outputs, gradients);
  else if (report.model == "rnn_critic")
    detail::rnn_critic(file, context, outputs, gradients);
  else if (report.model == "attention_generator")
    detail::attention_generator(file, context, outputs, gradients);
  else if (report.model == "attention_critic")
    detail::attention_critic(file, context, outputs, gradients);
  else if (report.model == "attention_classifier")
    detail::attention_classifier(file, context, outputs, gradients);
  else if (report.model == "lstm_baseline")
    detail::lstm_baseline(file, context, outputs, gradients);
  else if (report.model == "cnn_ranker")
    detail::ranker<CnnRanker>(file, context, outputs, gradients);
  else if (report.model == "rnn_ranker")
    detail::ranker<RnnRanker>(file, context, outputs, gradients);
  else if (report.model == "seq2seq")
    detail::seq2seq(file, context, outputs, gradients);
  else if (report.model == "erd")
    detail::next_pose_model<Erd>(file, context, outputs, gradients);
  else if (report.model == "lstm_3lr")
    detail::next_pose_model<Lstm3lr>(file, context, outputs, gradients);
  else
    throw Error(file.where(), ": no comparison for a model called \"", report.model,
                "\"; there are: cnn_generator, rnn_generator, cnn_critic, rnn_critic, attention_generator, "
                "attention_critic, attention_classifier, lstm_baseline, cnn_ranker, rnn_ranker, seq2seq, "
                "erd, lstm_3lr");
  add_errors(report, outputs);
  add_errors(report, gradients);
  report.outputs = outputs.size();
  report.gradients = gradients.size();
  return report;
}

}  // namespace motiongan::golden
