// Putting what a verb reads or makes on another skeleton.
#include "shared/retargeting.hpp"

#include "motiongan/motion/end_sites.hpp"
#include "shared/clip_reading.hpp"
#include "shared/show.hpp"

namespace motiongan::command {

void add_map_options(CLI::App& verb, Retargeting& retargeting) {
  verb.add_option("--map", retargeting.map,
                  "which joints belong together, as --save-map writes it [by names]")
      ->type_name("FILE");
  verb.add_flag("--end-sites", retargeting.end_sites,
                "give joints without children an End Site, which some readers of BVH demand");
  verb.add_option("--save-map", retargeting.save_map, "also write which joints belong together, to be edited")
      ->type_name("FILE");
}

void add_skeleton_options(CLI::App& verb, Retargeting& retargeting) {
  verb.add_option("--skeleton", retargeting.skeleton,
                  "put the motion on the skeleton of this motion file [the model's]")
      ->type_name("FILE");
  add_map_options(verb, retargeting);
}

TargetBody::TargetBody(const Retargeting& options, std::FILE* report) : options_(options), report_(report) {
  require(options.on() || (options.map.empty() && options.save_map.empty()),
          "--map and --save-map need --skeleton");
  if (!options.on()) return;
  const std::string extension = motion::extension_of(options.skeleton);
  if (extension == ".glb" || extension == ".vrm") {
    character_.emplace(options.skeleton);
    body_ = character_->motion();
    unit_metres_ = 1;
    return;
  }
  motion::LoadedMotion loaded = read_clip(options.skeleton, {.first_frame = motion::FirstFrame::keep});
  body_ = std::move(loaded.motion);
  unit_metres_ = loaded.unit_metres;
}

motion::Motion TargetBody::put(const motion::Motion& motion) {
  std::optional<double> rise;
  return put_piece(motion, rise);
}

motion::Motion TargetBody::put_piece(const motion::Motion& piece, std::optional<double>& rise) {
  return finished(options_.on() ? retargeter_of(piece).standing(piece, rise) : piece);
}

motion::Motion TargetBody::finished(motion::Motion motion) const {
  if (options_.end_sites) motion.skeleton = motion::with_end_sites(std::move(motion.skeleton));
  return motion;
}

const motion::Retargeter& TargetBody::retargeter_of(const motion::Motion& motion) {
  if (!retargeter_ || motion.skeleton != from_) begin(motion);
  return *retargeter_;
}

void TargetBody::begin(const motion::Motion& motion) {
  const bool first = !retargeter_;
  const motion::Skeleton &from = motion.skeleton, &to = body_.skeleton;
  const motion::JointMap map =
      options_.map.empty() ? find_joint_map(from, to) : motion::read_joint_map(options_.map, from, to);
  retargeter_.emplace(motion, body_, map);
  from_ = from;
  if (!first) return;
  if (!options_.save_map.empty()) motion::write_joint_map(options_.save_map, map, from, to);
  std::vector<std::vector<std::string>> rows;
  const auto names = [](const motion::BodyParts& body, motion::BodyPart part,
                        const motion::Skeleton& skeleton) {
    std::string all;
    if (const auto at = body.find(part); at != body.end())
      for (const std::size_t j : at->second) all += (all.empty() ? "" : ", ") + skeleton.joints[j].name;
    return all.empty() ? std::string("-") : all;
  };
  for (const auto& [part, name] : enum_names(motion::BodyPart{}))
    rows.push_back({name, names(map.from, part, from), names(map.to, part, to)});
  print_table({"", "from", "to"}, rows, "lll", "", report_);
  fmt::print(report_, "lengths times {}\n", brief(retargeter_->length_scale()));
  if (!options_.save_map.empty()) fmt::print(report_, "wrote {}\n", options_.save_map);
}

}  // namespace motiongan::command
