#include "serve/world.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "motiongan/core/error.hpp"

namespace motiongan::command {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are sent as they lie in memory");

constexpr double sent_again_seconds = 2;  // frames of so long can be asked for once more

template <class Number>
void append_number(std::string& out, Number value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

void append_count(std::string& out, std::uint64_t value) {
  append_number(out, static_cast<std::uint32_t>(value));
}

std::size_t frames_in(double seconds, double rate) {
  return static_cast<std::size_t>(std::ceil(seconds * rate - 1e-9));
}

}  // namespace

World::World(std::unique_ptr<Crowd> crowd, double rate) : crowd_(std::move(crowd)), rate_(rate) {}

World::Id World::add(const CrowdStart& start) {
  const Id id = crowd_->add(start);
  seen_[id].prompt = start.prompt;
  return id;
}

void World::remove(Id id) {
  crowd_->remove(id);
  seen_.erase(id);
}

void World::set_prompt(Id id, const std::string& prompt) {
  crowd_->set_prompt(id, prompt);
  seen_.at(id).prompt = prompt;
}

nlohmann::json World::list() const {
  nlohmann::json out = nlohmann::json::array();
  for (const auto& [id, seen] : seen_) {
    nlohmann::json one = {{"id", id}, {"prompt", seen.prompt}};
    if (const view::Figure& figure = seen.figure; figure.nodes() > 0) {
      std::vector<int> sides, heads(figure.heads.begin(), figure.heads.end());
      for (const view::Side side : figure.sides) sides.push_back(static_cast<int>(side));
      one["figure"] = {
          {"parents", figure.parents}, {"sides", sides}, {"heads", heads}, {"height", figure.height}};
    }
    out.push_back(std::move(one));
  }
  return out;
}

std::size_t World::most_frames() const { return std::max<std::size_t>(2, frames_in(1, rate_)); }

void World::keep(Seen& seen, const motion::Motion& frame) const {
  // In the skeleton of its first frame.
  seen.motion = seen.motion.frames == 0 ? frame : motion::join(std::move(seen.motion), frame);
  const std::size_t kept = frames_in(kept_seconds, rate_);
  if (seen.motion.frames >= kept + frames_in(5, rate_))  // not at every frame, for all are moved
    seen.motion = motion::slice(seen.motion, seen.motion.frames - kept, kept);
}

void World::step() {
  crowd_->step();
  std::string encoded;
  append_count(encoded, seen_.size());
  for (auto& [id, seen] : seen_) {
    view::ViewedMotion viewed{seen.prompt, crowd_->motion(id)};
    seen.figure = view::make_figure(viewed);
    keep(seen, viewed.motion);
    append_count(encoded, id);
    append_count(encoded, seen.figure.nodes());
    for (const motion::Vec3& point : seen.figure.points)
      for (const double x : point) append_number(encoded, static_cast<float>(x));
  }
  frames_.push_back(std::move(encoded));
  ++next_;
  if (frames_.size() > most_frames() + frames_in(sent_again_seconds, rate_)) frames_.pop_front();
}

std::string World::frames(std::optional<std::uint64_t> from, std::size_t count) {
  const std::uint64_t asked = from.value_or(next_), end = asked + count;
  require(asked <= next_, "from is ", asked, ", expected at most ", next_, ", the number of the next frame");
  require(count >= 1 && count <= most_frames(), "count is ", count, ", expected 1 to ", most_frames());
  while (next_ < end && size() > 0) step();
  const std::uint64_t oldest = next_ - frames_.size(), first = std::clamp(asked, oldest, next_);
  const std::uint64_t last = std::clamp(end, first, next_);
  std::string out;
  append_count(out, first);
  append_count(out, last - first);
  for (std::uint64_t f = first; f < last; ++f) out += frames_[static_cast<std::size_t>(f - oldest)];
  return out;
}

motion::Motion World::seen(Id id) const {
  const auto found = seen_.find(id);
  require(found != seen_.end(), "there is no character ", id);
  const motion::Motion& motion = found->second.motion;
  require(motion.frames > 0, "character ", id, " has not moved yet: nothing was seen of it");
  const std::size_t kept = std::min(motion.frames, frames_in(kept_seconds, rate_));
  return motion::slice(motion, motion.frames - kept, kept);
}

}  // namespace motiongan::command
