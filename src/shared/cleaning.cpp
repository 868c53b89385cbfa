// --clean: the clean-up of what a verb writes.
#include "shared/cleaning.hpp"

#include <algorithm>

#include "shared/quality.hpp"

namespace motiongan::command {

motion::Motion Cleaning::apply(motion::Motion motion, std::size_t given) const {
  if (!on()) return motion;
  const auto has = [&](const char* part) {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
  };
  motion::CleanOptions now = options;
  now.feet = has("feet"), now.smooth = has("smooth"), now.given = given;
  return motion::clean(motion, now);
}

namespace {
constexpr const char* group = "Clean-up";
}

void add_clean_choice(CLI::App& verb, Cleaning& cleaning, const std::string& without) {
  verb.add_option(
          "--clean", cleaning.parts,
          "what to clean up: smooth filters trembling, feet puts a floating body on the floor and holds "
          "feet still while they stand [" +
              without + "]")
      ->delimiter(',')
      ->check(CLI::IsMember({"feet", "smooth"}))
      ->type_name("feet,smooth")
      ->group(group);
  verb.add_option("--cutoff", cleaning.options.cutoff, "movements faster than that are filtered, in Hz")
      ->check(positive())
      ->capture_default_str()
      ->group(group);
}

void add_clean_options(CLI::App& verb, Cleaning& cleaning, const std::string& without) {
  add_clean_choice(verb, cleaning, without);
  add_body_options(verb, cleaning.options.unit_metres, cleaning.options.foot_joints, group);
}

}  // namespace motiongan::command
