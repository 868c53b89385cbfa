// --clean: the clean-up of what a verb writes.
#include "shared/cleaning.hpp"

#include <algorithm>

#include "shared/quality.hpp"

namespace motiongan::command {

motion::CleanOptions Cleaning::settings(std::size_t given) const {
  const auto has = [&](const char* part) {
    return std::find(parts.begin(), parts.end(), part) != parts.end();
  };
  motion::CleanOptions out = options;
  out.feet = has("feet"), out.smooth = has("smooth"), out.given = given;
  return out;
}

motion::Motion Cleaning::apply(motion::Motion motion, std::size_t given) const {
  return on() ? motion::clean(motion, settings(given)) : motion;
}

namespace {
constexpr const char* clean_group = "Clean-up";
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
      ->group(clean_group);
  verb.add_option("--cutoff", cleaning.options.cutoff, "movements faster than that are filtered, in Hz")
      ->check(positive())
      ->capture_default_str()
      ->group(clean_group);
}

void add_clean_options(CLI::App& verb, Cleaning& cleaning, const std::string& without) {
  add_clean_choice(verb, cleaning, without);
  add_body_options(verb, cleaning.options.unit_metres, cleaning.options.foot_joints, clean_group);
}

}  // namespace motiongan::command
