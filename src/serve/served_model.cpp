#include "serve/served_model.hpp"

#include <algorithm>

#include "generate/action_priors.hpp"
#include "motiongan/data/nearest_descriptions.hpp"
#include "motiongan/motion/position_rotations.hpp"
#include "motiongan/view/figure.hpp"
#include "shared/prompt.hpp"

namespace motiongan::command {
namespace {

constexpr std::size_t priors_of_a_class = 3;  // that are drawn from clips

/// The second of motion with rotations, as a stream takes it.
motion::Motion motion_of(const GivenPrior& given, const motion::PositionFormat& format) {
  const ActionPrior& prior = given.prior;
  return motion::motion_from_positions(
      {prior.id, prior.skeleton, format.rate, prior.places.size(), prior.positions}, given.reference);
}

/// Approximate height of a standing body of this skeleton, as figures are drawn.
double height_of(const motion::Skeleton& skeleton) {
  view::ViewedMotion rest{"", {skeleton, 1, 1, std::vector<motion::Quat>(skeleton.size()), {}}};
  for (const motion::Joint& joint : skeleton.joints) rest.motion.positions.push_back(joint.offset);
  return view::make_figure(rest).height;
}

}  // namespace

ServedModel::ServedModel(const Context& context, const ServedModelArgs& args, const CLI::App& verb) {
  const fs::path file = model_file(args.model);
  const fs::path given = fs::absolute(args.model).lexically_normal();
  name_ = (given.has_filename() ? given : given.parent_path()).filename().string();
  if (holds_model<ActionGan>(io::SafeTensors::read(file))) {
    actions_.emplace(load_with<ActionGan>(context, file, args.model, args.weights));
    find_priors(args, verb);
    return;
  }
  for (const char* name : {"--clip", "--data", "--up", "--scale", "--fps", "--bones"})
    require(verb.count(name) == 0, file.string(),
            " generates motion for a text: it has no classes, and takes no ", name);
  texts_.emplace(load_with<Dvgan>(context, file, args.model, args.weights));
}

void ServedModel::find_priors(const ServedModelArgs& args, const CLI::App& verb) {
  const motion::PositionFormat& format = actions_->format();
  ActionDataArgs data;
  data.folder = args.data;
  data.options.clips = args.reading;
  if (!args.clips.empty()) {
    require(args.data.empty(), "give --clip or --data, not both");
    fill_in_choices(data);
    std::vector<motion::Motion> all;
    for (const std::string& clip : args.clips)
      all.push_back(motion_of(read_prior(clip, format, data, 0), format));
    priors_.assign(format.classes.size(), all);
    return;
  }
  if (args.data.empty() && !actions_->starts().empty()) return;  // the model's own are continued
  const char* const remedy =
      "give clips whose first second characters continue with --clip CLIP (may be repeated), or the clips to "
      "draw from with --data FOLDER";
  const fs::path run =
      fs::is_directory(args.model) ? fs::path(args.model) : fs::path(args.model).parent_path();
  require(fs::exists(RunFiles{run}.split()), args.model,
          " is not in the folder of a run from whose clips a second ", "could be drawn; ", remedy);
  take_data_of_run(data, verb, run, remedy);
  if (!args.data.empty()) data.folder = args.data, data.procedural = 0;
  fill_in_choices(data);
  const std::vector<SplitLine> lines = read_split(RunFiles{run}.split());
  const auto tested = [&](const std::string& label) {
    return std::any_of(lines.begin(), lines.end(),
                       [&](const SplitLine& line) { return !line.train && line.label == label; });
  };
  const auto known = std::find_if(format.classes.begin(), format.classes.end(), tested);
  require(known != format.classes.end(), run.string(), " held no clips out for testing that could be drawn; ",
          remedy);
  for (std::size_t label = 0; label < format.classes.size(); ++label) {
    const bool own = tested(format.classes[label]);
    if (!own)
      fmt::print(stderr,
                 "motiongan: no clip of class '{}' was held out for testing: it continues clips of '{}'\n",
                 format.classes[label], *known);
    const std::size_t from = own ? label : static_cast<std::size_t>(known - format.classes.begin());
    std::vector<motion::Motion>& out = priors_.emplace_back();
    for (const GivenPrior& prior : draw_priors(run, format, data, from, 1, 0, priors_of_a_class))
      out.push_back(motion_of(prior, format));
  }
}

void ServedModel::warm_up() const {
  const std::vector<std::string>& prompts =
      has_classes() ? actions_->format().classes : texts_->format().descriptions;
  const std::unique_ptr<Crowd> crowd = new_crowd();
  crowd->add({.prompt = prompts.empty() ? "walk" : prompts.front()});
  crowd->step();
}

std::unique_ptr<Crowd> ServedModel::new_crowd() const {
  if (actions_) return stream_crowd(*actions_, priors_);
  return texts_->is_recurrent() ? stream_crowd(*texts_) : window_crowd(*texts_);
}

nlohmann::json ServedModel::describe() const {
  const auto about = [&](const auto& format, const char* made, const std::vector<std::string>& prompts) {
    return nlohmann::json{{"name", name_},       {"classes", has_classes()},
                          {"made", made},        {"height", height_of(format.skeleton())},
                          {"rate", format.rate}, {"window", format.frames},
                          {"prompts", prompts},  {"unit", unit_metres()}};
  };
  if (actions_) return about(actions_->format(), "seconds", actions_->format().classes);
  const motion::MotionFormat& format = texts_->format();
  return about(format, texts_->is_recurrent() ? "frames" : "windows", format.descriptions);
}

PromptNotes ServedModel::notes_on(const std::string& prompt) const {
  PromptNotes out;
  if (actions_) return out;
  const motion::MotionFormat& format = texts_->format();
  out.remark = motion::word_limit_note(prompt);
  out.unknown = format.vocabulary.unknown_words(prompt);
  if (!out.unknown.empty()) out.nearest = motion::nearest_descriptions(format.descriptions, prompt);
  return out;
}

}  // namespace motiongan::command
