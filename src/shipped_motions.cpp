// What the shipped models make of some of their descriptions and classes.
#include "shipped_motions.hpp"

#include <functional>
#include <iterator>

#include "motiongan/formats/bvh.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/shipped_models.hpp"
#include "motiongan/sample/action_generate.hpp"
#include "shared/cleaning.hpp"
#include "shared/prompt.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

constexpr std::size_t motions_shown = 12;
constexpr double shown_rate = 30, class_seconds = 3;

/// A shipped model, of either kind.
struct ShownModel {
  std::vector<std::string> subjects;  ///< descriptions or classes, in the model's order
  std::function<motion::Motion(std::size_t subject, std::uint32_t sample)> make;
};

ShownModel shown_text_model(Dvgan model) {
  std::vector<std::string> texts = model.format().descriptions;
  return {std::move(texts), [model = std::move(model)](std::size_t subject, std::uint32_t sample) {
            return model
                .generate(model.format().descriptions[subject],
                          {.count = 1, .seed = 1, .first_sample = sample})
                .front();
          }};
}

ShownModel shown_class_model(ActionGan model) {
  std::vector<std::string> classes = model.format().classes;
  return {std::move(classes), [model = std::move(model)](std::size_t subject, std::uint32_t sample) {
            const ActionStart& start = *model.start(subject, 0);
            const ActionSchedule schedule =
                parse_action_schedule(model.format().classes[subject], model.format(), class_seconds);
            const auto clips = model.generate(std::vector{start.prior}, schedule,
                                              {.with_prior = false, .seed = 1, .first_sample = sample});
            return motion_from_positions(clips.front(), start.rotations);
          }};
}

/// The shipped models, those that take a text first. A model of classes whose file keeps no second to
/// continue is left out.
std::vector<ShownModel> shown_models(const Context& context) {
  std::vector<ShownModel> out, of_classes;
  for (const ShippedModel& model : shipped_models()) {
    check_shipped(model);
    const io::SafeTensors file = io::SafeTensors::read(model.file);
    const std::string where = model.file.string();
    if (holds_model<Dvgan>(file)) out.push_back(shown_text_model(model_from<Dvgan>(context, file, where)));
    if (!holds_model<ActionGan>(file)) continue;
    if (auto actions = model_from<ActionGan>(context, file, where); !actions.starts().empty())
      of_classes.push_back(shown_class_model(std::move(actions)));
  }
  std::move(of_classes.begin(), of_classes.end(), std::back_inserter(out));
  return out;
}

}  // namespace

void show_shipped_motions(const Context& context, const fs::path& out) {
  const std::vector<ShownModel> models = shown_models(context);
  if (models.empty()) {
    fmt::print("no shipped model is installed\n");
    return;
  }
  make_folder(out / "shipped");
  const Cleaning cleaning{{"feet"}, {}};  // they do not tremble
  std::vector<view::ViewedMotion> page;
  const auto is_shown = [&](const std::string& subject) {
    return std::any_of(page.begin(), page.end(),
                       [&](const auto& shown) { return slug(shown.title) == slug(subject); });
  };
  // Each model in turn makes the next of its subjects that no other has made.
  for (std::size_t turn = 0, without = 0; page.size() < motions_shown && without < models.size(); ++turn) {
    const ShownModel& model = models[turn % models.size()];
    const auto subject = std::find_if_not(model.subjects.begin(), model.subjects.end(), is_shown);
    without = subject == model.subjects.end() ? without + 1 : 0;
    if (without > 0) continue;
    motion::Motion made = model.make(static_cast<std::size_t>(subject - model.subjects.begin()),
                                     static_cast<std::uint32_t>(page.size()));
    made = motion::resample(cleaning.apply(std::move(made)), shown_rate);
    motion::write_bvh(out / "shipped" / (slug(*subject) + ".bvh"), made);
    page.push_back({*subject, std::move(made)});
  }
  fmt::print("wrote {}: {} BVH files\n", (out / "shipped").string(), page.size());
  show_page(out / "shipped.html", page, "motiongan: what the shipped models make of a text or a class", 4);
  show_strip(out / "shipped.png", page);
}

}  // namespace motiongan::command
