// A golden file (a model's parameters, inputs, outputs and gradients from PyTorch), and the report of a
// comparison.
#pragma once
#include <motiongan/nn/state_dict.hpp>
#include <motiongan/nn/text_encoder.hpp>
#include <motiongan/train/wgan_gp.hpp>

namespace motiongan::golden {

/// One tensor, ours and PyTorch's.
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
  bool passed() const { return worst <= tolerance; }  // false for NaN
};

inline double norm(const std::vector<double>& v) {
  double s = 0;
  for (double x : v) s += x * x;
  return std::sqrt(s);
}

/// |ours - theirs| relative to the larger of |theirs| and a hundredth of the largest |theirs| of the group:
/// some gradients are zero by symmetry, and their rounding errors are meaningless.
inline void add_errors(Report& report, const std::vector<Pair>& group) {
  double largest = 0;
  for (const Pair& p : group) largest = std::max(largest, norm(p.theirs));
  for (const Pair& p : group) {
    require(p.ours.size() == p.theirs.size(), p.name, ": ours has ", p.ours.size(), " values, the file ",
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
            "\" is \"", value, "\", expected an integer");
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

/// Scores, penalty and loss of any critic, and their gradients; `judge` is passed to critic_loss().
inline void add_critic(const File& file, const std::vector<NamedParameter>& parameters,
                       const CriticFn& critic_pairs, const CriticFn& judge, Pairs& outputs,
                       Pairs& gradients) {
  const Context& context = parameters.front().value->context();
  const Tensor real = file.tensor(context, "in.real"), fake = file.tensor(context, "in.fake");
  const CriticLoss loss =
      critic_loss(critic_pairs, judge, real, fake, file.tensor(context, "in.epsilon"), 10);
  const std::size_t batch = real.dim(1);
  outputs.push_back(output(file, "out.real", slice(loss.scores, 0, 0, batch)));
  outputs.push_back(output(file, "out.fake", slice(loss.scores, 0, batch, batch)));
  outputs.push_back(output(file, "out.penalty", loss.penalty));
  outputs.push_back(output(file, "out.loss", loss.loss));
  add_gradients(gradients, file, parameters, grad(loss.loss, values_of(parameters)));
  const Var leaf = Var::leaf(fake);
  const Var of_fake = grad(generator_loss(judge(leaf)), {leaf})[0];
  gradients.push_back({"grad.in.fake", of_fake.value().to_host<double>(), file.values("grad.in.fake")});
}

}  // namespace detail
}  // namespace motiongan::golden
