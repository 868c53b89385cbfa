#include "serve/crowd.hpp"

#include <map>
#include <utility>

#include "motiongan/core/error.hpp"
#include "motiongan/data/vocabulary.hpp"
#include "motiongan/motion/motion.hpp"
#include "motiongan/sample/character_stream.hpp"

namespace motiongan::command {
namespace {

class StreamCrowd : public Crowd {
 public:
  explicit StreamCrowd(const Dvgan& model) : stream_(model) {}
  StreamCrowd(const ActionGan& model, const std::vector<std::vector<motion::Motion>>& priors)
      : stream_(model), classes_(&model.format()), priors_(&priors) {}

  Id add(const CrowdStart& start) override {
    CharacterStart given{.prompt = start.prompt, .seed = start.seed, .sample = start.sample};
    given.at = start.at;
    if (priors_ != nullptr && !priors_->empty()) {
      const std::vector<motion::Motion>& own = (*priors_)[classes_->class_index(start.prompt)];
      given.prior = &own[start.sample % own.size()];
    }
    return stream_.add(given);
  }
  void remove(Id id) override { stream_.remove(id); }
  void set_prompt(Id id, const std::string& prompt) override { stream_.set_prompt(id, prompt); }
  void step() override { stream_.step(); }
  motion::Motion motion(Id id) const override { return stream_.motion(id); }

 private:
  CharacterStream stream_;
  const motion::PositionFormat* classes_ = nullptr;
  const std::vector<std::vector<motion::Motion>>* priors_ = nullptr;
};

class WindowCrowd : public Crowd {
 public:
  explicit WindowCrowd(const Dvgan& model) : model_(model) {}

  Id add(const CrowdStart& start) override {
    model_.format().vocabulary.encode(start.prompt);  // throws for a text without words
    characters_[next_].start = start;
    return next_++;
  }
  void remove(Id id) override {
    character(id);
    characters_.erase(id);
  }
  void set_prompt(Id id, const std::string& prompt) override {
    character(id);
    model_.format().vocabulary.encode(prompt);
    Character& c = characters_.at(id);
    c.changed = c.changed || c.start.prompt != prompt;
    c.start.prompt = prompt;
  }
  void step() override {
    for (auto& entry : characters_) {
      Character& c = entry.second;
      if (c.frame + 1 < c.window.frames && !c.changed)
        ++c.frame;
      else
        renew(c);
    }
  }
  motion::Motion motion(Id id) const override {
    const Character& c = character(id);
    require(c.window.frames > 0, "character ", id, " has not moved since it was added");
    return motion::slice(c.window, c.frame, 1);
  }

 private:
  struct Character {
    CrowdStart start;
    motion::Motion window = {};
    std::size_t frame = 0;  // of the window, that of the last step
    bool changed = false;   // its text, since then
  };

  const Character& character(Id id) const {
    const auto found = characters_.find(id);
    require(found != characters_.end(), "there is no character ", id);
    return found->second;
  }

  /// Makes the character's next window, from where it is.
  void renew(Character& c) const {
    const motion::PoseLayout& layout = model_.format().layout;
    const motion::RootTrack to = c.window.frames > 0 ? layout.track_of(c.window, c.frame) : c.start.at;
    std::vector<motion::Motion> made =
        model_.generate(c.start.prompt, {.count = 1, .seed = c.start.seed, .first_sample = c.start.sample});
    ++c.start.sample;
    c.window = motion::placed_at(std::move(made.front()), layout.root(), to, layout.has_yaw());
    c.frame = 0;
    c.changed = false;
  }

  const Dvgan& model_;
  std::map<Id, Character> characters_;
  Id next_ = 0;
};

}  // namespace

std::unique_ptr<Crowd> stream_crowd(const Dvgan& model) { return std::make_unique<StreamCrowd>(model); }

std::unique_ptr<Crowd> stream_crowd(const ActionGan& model,
                                    const std::vector<std::vector<motion::Motion>>& priors) {
  return std::make_unique<StreamCrowd>(model, priors);
}

std::unique_ptr<Crowd> window_crowd(const Dvgan& model) { return std::make_unique<WindowCrowd>(model); }

}  // namespace motiongan::command
