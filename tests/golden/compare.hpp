// Runs a model on a golden file (its parameters, inputs and outputs, and all gradients, as PyTorch has them)
// and says how far ours are from theirs.
#pragma once
#include <motiongan/io/state_dict.hpp>
#include <motiongan/models/cnn_critic.hpp>
#include <motiongan/models/cnn_generator.hpp>
#include <motiongan/models/rnn_critic.hpp>
#include <motiongan/models/rnn_generator.hpp>
#include <motiongan/train/wgan_gp.hpp>

namespace motiongan::golden {

/// One tensor of ours beside theirs.
struct Pair {
  std::string name;
  std::vector<double> ours, theirs;
};

struct Report {
  std::string model, dtype;
  std::string worst_name;
  double worst = 0;  ///< see relative_errors
  std::size_t outputs = 0, gradients = 0;
  double tolerance = 0;
  bool passed() const { return worst <= tolerance; }  // false for a NaN as well
};

inline double norm(const std::vector<double>& v) {
  double s = 0;
  for (double x : v) s += x * x;
  return std::sqrt(s);
}

/// |ours - theirs| against the larger of |theirs| and a hundredth of the largest |theirs| of the group: some
/// gradients are zero by symmetry, and their rounding errors mean nothing.
inline void add_errors(Report& report, const std::vector<Pair>& group) {
  double largest = 0;
  for (const Pair& p : group) largest = std::max(largest, norm(p.theirs));
  for (const Pair& p : group) {
    require(p.ours.size() == p.theirs.size(), p.name, ": ours has ", p.ours.size(), " numbers, the file ",
            p.theirs.size());
    std::vector<double> difference(p.ours.size());
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = p.ours[i] - p.theirs[i];
    const double scale = std::max(norm(p.theirs), largest / 100),
                 error = norm(difference) / (scale > 0 ? scale : 1);
    if (!(error <= report.worst)) {
      report.worst = error;
      report.worst_name = p.name;
    }
  }
}

class File {
 public:
  explicit File(const std::filesystem::path& path)
      : where_(path.string()), content_(io::SafeTensors::read(path)) {}

  const std::string& where() const { return where_; }
  const io::SafeTensors& content() const { return content_; }

  std::string text(const std::string& key) const {
    const auto found = content_.metadata.find(key);
    require(found != content_.metadata.end(), where_, ": the metadata has no \"", key,
            "\"; is this a golden file of torch_peer.py?");
    return found->second;
  }
  std::size_t number(const std::string& key) const {
    const std::string value = text(key);
    std::size_t n = 0;
    const auto [end, code] = std::from_chars(value.data(), value.data() + value.size(), n);
    require(code == std::errc() && end == value.data() + value.size(), where_, ": the metadata's \"", key,
            "\" is \"", value, "\", expected a whole number");
    return n;
  }
  std::vector<double> values(const std::string& name) const { return content_.at(name).as<double>(); }
  std::vector<std::int64_t> integers(const std::string& name) const {
    return content_.at(name).as<std::int64_t>();
  }
  Tensor tensor(const Context& context, const std::string& name) const {
    return Tensor::from(context, content_.at(name).shape, values(name));
  }

  Sentences sentences(const Context& context) const {
    const auto words = integers("in.words"), lengths = integers("in.lengths");
    const std::size_t longest = content_.at("in.words").shape.at(1);
    std::vector<std::vector<int>> sentences;
    for (std::size_t b = 0; b < lengths.size(); ++b) {
      const auto first = words.begin() + static_cast<std::ptrdiff_t>(b * longest);
      sentences.emplace_back(first, first + lengths[b]);
    }
    return Sentences(context, sentences, number("vocab"));
  }

 private:
  std::string where_;
  io::SafeTensors content_;
};

namespace detail {

using Pairs = std::vector<Pair>;

inline Pair output(const File& file, const std::string& name, const Var& ours) {
  return {name, ours.value().to_host<double>(), file.values(name)};
}

inline void add_gradients(Pairs& pairs, const File& file, const std::vector<NamedParameter>& parameters,
                          const std::vector<Var>& gradients) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const std::string name = "grad." + parameters[i].name;
    pairs.push_back({name, io::to_file_order(parameters[i], gradients[i].value()), file.values(name)});
  }
}

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

/// Scores, penalty and loss of any critic of text and motion, and their gradients.
template <class Critic>
void critic(Critic model, const File& file, const Context& context, Pairs& outputs, Pairs& gradients) {
  const auto parameters = named_parameters(model);
  io::load_parameters(parameters, file.content(), file.where(), "param.");
  const Var h_txt = model.encode_text(file.sentences(context)), both = concat_axis({h_txt, h_txt}, 0);
  const Tensor real = file.tensor(context, "in.real"), fake = file.tensor(context, "in.fake");
  const CriticLoss loss =
      critic_loss([&](const Var& x) { return model(x, both); }, [&](const Var& x) { return model(x, h_txt); },
                  real, fake, file.tensor(context, "in.epsilon"), 10);
  const std::size_t batch = real.dim(1);
  outputs.push_back(output(file, "out.real", slice(loss.scores, 0, 0, batch)));
  outputs.push_back(output(file, "out.fake", slice(loss.scores, 0, batch, batch)));
  outputs.push_back(output(file, "out.penalty", loss.penalty));
  outputs.push_back(output(file, "out.loss", loss.loss));
  add_gradients(gradients, file, parameters, grad(loss.loss, values_of(parameters)));
  const Var leaf = Var::leaf(fake);
  const Var of_fake = grad(generator_loss(model(leaf, h_txt)), {leaf})[0];
  gradients.push_back({"grad.in.fake", of_fake.value().to_host<double>(), file.values("grad.in.fake")});
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

/// Compares one file, in the precision it was written in.
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
  else
    throw Error(file.where(), ": no comparison for a model called \"", report.model,
                "\"; there are: cnn_generator, rnn_generator, cnn_critic, rnn_critic");
  add_errors(report, outputs);
  add_errors(report, gradients);
  report.outputs = outputs.size();
  report.gradients = gradients.size();
  return report;
}

}  // namespace motiongan::golden
