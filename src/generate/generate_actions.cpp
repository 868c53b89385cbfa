// motiongan generate for class-conditioned models: continues a second of motion by a schedule of classes.
#include "generate/generate_actions.hpp"

#include "generate/action_priors.hpp"
#include "motiongan/data/clip_source.hpp"
#include "motiongan/sample/action_generate.hpp"
#include "motiongan/view/heat_map.hpp"
#include "shared/action_files.hpp"
#include "shared/outputs.hpp"
#include "shared/prompt.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

constexpr std::size_t characters_at_a_time = 64, directed_at_a_time = 16;

/// Whether the options say how long motions are.
bool has_length(const ActionGenerateArgs& args) {
  const std::size_t comma = args.schedule.rfind(','), colon = args.schedule.rfind(':');
  const bool timed = colon != std::string::npos && (comma == std::string::npos || colon > comma);
  return args.frames > 0 || args.seconds > 0 || timed;
}

/// Duration in seconds; 0 if the schedule gives it.
double asked_seconds(const ActionGenerateArgs& args, double rate) {
  require(args.seconds <= 0 || args.frames == 0, "give --seconds or --frames, not both");
  if (args.frames > 0) return static_cast<double>(args.frames) / rate;
  if (args.seconds > 0) return args.seconds;
  return has_length(args) ? 0 : 10;
}

/// The priors; `inputs` are the files, or the folder, that they were read from.
std::vector<GivenPrior> find_priors(const ActionGenerateArgs& args, const CLI::App& verb,
                                    const fs::path& file, const ActionGan& model, std::size_t label,
                                    std::vector<fs::path>& inputs) {
  ActionDataArgs data;
  data.folder = args.data;
  data.options.clips = args.clips;
  const motion::PositionFormat& format = model.format();
  inputs = inputs_of(args.from, {args.clips.bones.string()});
  if (!args.from.empty()) {
    fill_in_choices(data);
    require(args.data.empty(), "give --from or --data, not both");
    std::vector<GivenPrior> given, out;
    for (const std::string& clip : args.from)
      for (const double at : args.at.empty() ? std::vector<double>{0} : args.at)
        given.push_back(read_prior(clip, format, data, at));
    require(args.count == 1 || model.options().noise_dim > 0, "--count ", args.count,
            ": this model has no noise, so a prior and a class give only one motion; repeat --from or --at, ",
            "or leave --from out to draw priors from the run's test clips");
    for (const GivenPrior& prior : given) out.insert(out.end(), args.count, prior);
    return out;
  }
  require(args.at.empty(), "--at needs --from: it says where in that clip the motion starts");
  if (args.data.empty() && !fs::is_directory(args.model))
    if (std::vector<GivenPrior> kept = kept_priors(model, label, args.first_sample, args.count);
        !kept.empty())
      return kept;
  const fs::path run = fs::is_directory(args.model) ? fs::path(args.model) : file.parent_path();
  require(fs::exists(RunFiles{run}.split()), "give the second to continue with --from CLIP: ", file.string(),
          " keeps none, and is not in the folder of a run from whose clips one could be drawn");
  take_data_of_run(
      data, verb, run,
      "give the second to continue with --from CLIP, or the clips to draw one from with --data FOLDER");
  if (!args.data.empty()) data.folder = args.data, data.procedural = 0;
  fill_in_choices(data);
  inputs.push_back(data.folder);
  return draw_priors(run, format, data, label, args.seed, args.first_sample, args.count);
}

/// Draws the generator's attention over the first second of up to four characters.
void draw_attention(const ActionGenerateArgs& args, const ActionGan& model,
                    const std::vector<GivenPrior>& priors, std::size_t label) {
  const motion::PositionFormat& format = model.format();
  const std::size_t count = std::min<std::size_t>(4, priors.size()), frames = format.frames,
                    dof = format.dof();
  std::vector<float> poses(frames * count * dof);
  for (std::size_t f = 0; f < frames; ++f)
    for (std::size_t b = 0; b < count; ++b)
      std::copy_n(&priors[b].prior.poses[f * dof], dof, &poses[(f * count + b) * dof]);
  const NoGrad values_only;
  const std::vector<float> values =
      model.generator()
          .attention_map(Var::constant(Tensor::from(model.context(), {frames, count, dof}, poses)),
                         Var::constant(one_hot(model.context(), std::vector<std::size_t>(count, label),
                                               format.classes.size())),
                         model.noise(count, {.seed = args.seed,
                                             .first_sample = static_cast<std::uint32_t>(args.first_sample)}))
          .value()
          .to_host();  // [count, T, T]
  std::vector<view::HeatMap> maps;
  for (std::size_t b = 0; b < count; ++b) {
    const auto first = values.begin() + static_cast<std::ptrdiff_t>(b * frames * frames);
    maps.push_back(
        {priors[b].from, frames, frames, {first, first + static_cast<std::ptrdiff_t>(frames * frames)}});
  }
  make_folder_of(args.attention_map);
  write_png(args.attention_map,
            view::heat_map(maps, {.title = "generator's attention, class " + format.classes[label],
                                  .row_label = "attending frame",
                                  .column_label = "attended frame"}));
  fmt::print("wrote {}: which frames of the first second attend to which (gamma {})\n", args.attention_map,
             brief(model.generator().attention()->gamma.item(), 3));
}

/// Cleans directed motions up, measures what is written of them, and leaves the given second out if it is not
/// wanted.
void finish_directed(const ActionGenerateArgs& args, const motion::PositionFormat& format,
                     const Direction& wanted, std::vector<DirectedAction>& directed,
                     std::vector<motion::PositionClip>& clips, std::vector<motion::Motion>& motions) {
  for (std::size_t i = 0; i < directed.size(); ++i) {
    motion::Motion& motion = motions[i];
    if (args.cleaning.on()) {
      motion = args.cleaning.apply(std::move(motion), format.frames);
      directed[i].clip.positions = motion::joint_positions(motion);
      directed[i].errors = constraint_errors(format, from_last_given(directed[i]), wanted.constraints);
    }
    if (args.with_prior) continue;
    clips[i] = from_last_given(directed[i]);
    clips[i].positions.erase(
        clips[i].positions.begin(),
        clips[i].positions.begin() + static_cast<std::ptrdiff_t>(clips[i].skeleton.size()));
    --clips[i].frames;
    if (motion.frames > 0) motion = slice(motion, format.frames, motion.frames - format.frames);
  }
}

std::string name_of(const motion::PositionFormat& format, const ActionSchedule& schedule) {
  std::string classes;
  for (const ActionPiece& piece : schedule) classes += format.classes[piece.label] + " ";
  const std::string name = slug(classes);
  return name.empty() ? "motion" : name;
}

}  // namespace

void add_action_options(CLI::App& verb, ActionGenerateArgs& a) {
  const auto option = [&](const char* name, auto& member, const char* text) {
    return verb.add_option(name, member, text)->group("Class-conditioned models");
  };
  option("--class", a.schedule, "a class, or a sequence of classes such as walk:3s,run:90 (frames)")
      ->type_name("SCHEDULE");
  option("--seconds", a.seconds,
         "duration, if --class does not give it [10; as long as what is asked for needs, if "
         "the motion is directed]")
      ->check(positive());
  option(
      "--from", a.from,
      "clip with the second to continue; may be repeated [one that the model's file keeps, else drawn from "
      "the run's test clips]")
      ->type_name("CLIP")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  option("--at", a.at, "where in the clip that second starts, in seconds; may be repeated [0]")
      ->check(CLI::Range(0.0, 1e6))
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  option("--data", a.data, "folder of the clips to draw from [that of the run]")->type_name("FOLDER");
  add_options(verb, fields_of(a.clips), "Class-conditioned models",
              {.only = {"up", "scale", "fps", "bones"}});
  verb.add_flag("--prior,!--no-prior", a.with_prior, "begin each file with the given second [on]")
      ->group("Class-conditioned models");
  option("--attention-map", a.attention_map,
         "picture to write: which frames of the first second attend to which")
      ->type_name("FILE.png");
}

std::string given_action_options(const CLI::App& verb) {
  std::string out;
  for (const char* name : {"--class", "--seconds", "--from", "--at", "--data", "--up", "--scale", "--fps",
                           "--bones", "--prior", "--attention-map"})
    if (verb.count(name) > 0) out += (out.empty() ? "" : ", ") + std::string(name);
  return out;
}

int generate_actions(ActionGenerateArgs args, const CLI::App& verb, const fs::path& file,
                     const Communicator* ranks) {
  const Context context;
  ActionGan model = load_with<ActionGan>(context, file, args.model, args.weights);
  const motion::PositionFormat& format = model.format();
  require(!args.schedule.empty(),
          "no class is given; use --class NAME or --class NAME:3s,OTHER:5s. The classes are: ",
          quoted_list(format.classes));
  ActionSchedule schedule = parse_action_schedule(args.schedule, format, asked_seconds(args, format.rate));
  const bool rotates = has_rotations(args.format);
  require(!args.cleaning.on() || rotates, "--clean works on rotations, which --format ", args.format,
          " does not hold; use --format bvh");
  require(!args.retargeting.on() || rotates, "--skeleton works on rotations, which --format ", args.format,
          " does not hold; use --format bvh");
  TargetBody body(args.retargeting);
  check_samples(args.first_sample, args.count);
  const std::size_t first_label = schedule.front().label;
  if (!args.attention_map.empty())
    require(!model.is_baseline() && model.options().attention,
            "--attention-map: this model has no attention");
  std::vector<fs::path> files, inputs;
  std::vector<GivenPrior> priors = find_priors(args, verb, file, model, first_label, inputs);
  Direction wanted;
  DirectOptions direct_options = args.directing.options;
  if (args.directing.on()) {
    wanted = read_direction(args.directing, format);
    use_critic(direct_options, model, args.model);
    direct_options.seed = args.seed;
    if (!has_length(args)) {
      std::vector<ActionPrior> some;
      for (const GivenPrior& prior : priors) some.push_back(prior.prior);
      const std::size_t needed = frames_needed(model, some, first_label, wanted, args.seed);
      schedule = parse_action_schedule(args.schedule, format, static_cast<double>(needed) / format.rate);
    }
  }
  const Share share = share_of(priors.size(), ranks);
  if (share.count == 0) return 0;
  const auto mine = priors.begin() + static_cast<std::ptrdiff_t>(share.first);
  priors = {mine, mine + static_cast<std::ptrdiff_t>(share.count)};
  args.first_sample += share.first;
  const fs::path out = args.out;
  const std::string name = name_of(format, schedule);
  for (std::size_t i = 0; i < priors.size(); ++i)
    files.push_back(out / fmt::format("{}_{:03}.{}", name, args.first_sample + i, args.format));
  check_outputs("--out", files, inputs);
  if (!rotates) check_outputs("--out", {out / motion::bone_list_name}, inputs);
  make_folder(out);
  if (!rotates) write_bones_beside(out, priors.front().prior.skeleton);
  const bool shows = !args.html.empty() || !args.png.empty();
  std::vector<view::ViewedMotion> shown;
  std::vector<std::vector<ConstraintError>> errors;
  const std::size_t at_a_time = args.directing.on() ? directed_at_a_time : characters_at_a_time;
  for (std::size_t first = 0; first < priors.size(); first += at_a_time) {
    const std::size_t count = std::min(at_a_time, priors.size() - first);
    std::vector<ActionPrior> some;
    for (std::size_t i = 0; i < count; ++i) some.push_back(priors[first + i].prior);
    std::vector<motion::PositionClip> clips;
    std::vector<DirectedAction> directed;
    if (args.directing.on()) {
      direct_options.first_sample = args.first_sample + first;
      directed = make_directed(model, some, schedule, direct_options, wanted);
      for (const DirectedAction& made : directed) clips.push_back(made.clip);
    } else {
      clips = model.generate(some, schedule,
                             {.with_prior = args.with_prior,
                              .seed = args.seed,
                              .first_sample = static_cast<std::uint32_t>(args.first_sample + first)});
    }
    std::vector<motion::Motion> motions(count);
    motion::in_two_threads(count, [&](std::size_t i) {
      if (shows || rotates) motions[i] = motion_from_positions(clips[i], priors[first + i].reference);
    });
    finish_directed(args, format, wanted, directed, clips, motions);
    for (const DirectedAction& made : directed) errors.push_back(made.errors);
    if (rotates)
      for (motion::Motion& motion : motions) motion = body.put(motion);
    motion::in_two_threads(count, [&](std::size_t i) {
      if (directed.empty())
        motions[i] = args.cleaning.apply(std::move(motions[i]), args.with_prior ? format.frames : 0);
      write_action_clip(files[first + i], clips[i], motions[i], args.rate,
                        body.unit_metres(format.space.unit_metres), body.character());
    });
    for (std::size_t i = 0; shows && i < count; ++i) {
      const std::size_t given = !args.with_prior ? 0
                                : args.rate > 0
                                    ? motion::resampled_frames(format.frames, format.rate, args.rate)
                                    : format.frames;
      shown.push_back({fmt::format("{} ({})", args.schedule, priors[first + i].from),
                       for_page(motions[i], args.rate), given});
      if (!directed.empty() && !args.retargeting.on()) {
        const double begin = args.with_prior ? static_cast<double>(format.frames - 1) / format.rate : 0;
        shown.back().marks = marks_of(wanted.constraints, motions[i], 0, begin);
      }
    }
  }
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < std::min<std::size_t>(files.size(), 20); ++i)
    rows.push_back({files[i].string(), priors[i].from});
  print_table({"file", "continues"}, rows, "ll");
  if (files.size() > rows.size()) fmt::print("and {} more\n", files.size() - rows.size());
  const std::size_t made = frames_of(schedule);
  fmt::print("wrote {}: {}{} generated frames ({})\n", counted(files.size(), "file"),
             args.with_prior ? fmt::format("{}, then ", counted(format.frames, "given frame")) : "", made,
             duration(static_cast<double>(made) / format.rate));
  fmt::print("space: {}\n", describe(format.space));
  const bool met = errors.empty() || print_constraint_errors(errors, motion::body_unit(format.skeleton()));
  if (!args.attention_map.empty()) draw_attention(args, model, priors, first_label);
  if (!args.html.empty()) show_page(args.html, shown, "generated by " + file.string());
  if (!args.png.empty()) show_strip(args.png, shown);
  return met ? 0 : exit_not_met;
}

}  // namespace motiongan::command
