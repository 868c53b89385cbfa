// What a motion that is generated has to meet: the options of generate for paths, poses, points and loops.
#pragma once
#include <memory>
#include <optional>

#include "motiongan/direct/action_direct.hpp"
#include "motiongan/direct/direct.hpp"
#include "motiongan/train/progress.hpp"
#include "motiongan/view/figure.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

struct Directing {
  std::string path;                                           ///< a file; empty: none
  std::vector<std::string> keyframes, joints, hands, stands;  ///< as on the command line
  std::optional<double> loop;                                 ///< seconds; 0: the whole motion
  DirectOptions options;

  bool on() const {
    return !path.empty() || !keyframes.empty() || !joints.empty() || !hands.empty() || !stands.empty() ||
           loop;
  }
  /// The files that they name.
  std::vector<fs::path> inputs() const;
};

/// Adds them to the verb.
void add_direct_options(CLI::App& verb, Directing& directing);
/// Adds those of the optimisation alone; --exact is one of them only where it is a choice.
void add_optimiser_options(CLI::App& verb, DirectOptions& options, bool with_exact = true);

/// What the options ask for, in the model's terms.
struct Direction {
  std::vector<Constraint> constraints;
  std::vector<PathPoint> points;  ///< of the path
  double last = 0;                ///< the latest time that is named, in seconds
};

/// Reads the files and checks what was written. Throws Error, naming the option, for what cannot be read.
Direction read_direction(const Directing& directing, const motion::MotionFormat& format);
Direction read_direction(const Directing& directing, const motion::PositionFormat& format);

/// Sets `options` to show progress on stderr, and to end early after a signal, with what there is by then.
/// Ends the line when it is destroyed.
class ShownProgress {
 public:
  explicit ShownProgress(DirectOptions& options);
  ~ShownProgress();
  ShownProgress(const ShownProgress&) = delete;
  ShownProgress& operator=(const ShownProgress&) = delete;

 private:
  std::shared_ptr<ProgressBar> bar_;
};

/// If `given` is the folder of a run, its critic chooses among the starts that meet everything.
void use_critic(DirectOptions& options, const Dvgan& model, const fs::path& given);
void use_critic(DirectOptions& options, const ActionGan& model, const fs::path& given);

/// Directs motions of a text. Their length is what is asked for, or else what the constraints need: for a
/// path without times, as long as the model takes at its own pace.
std::vector<DirectedMotion> make_directed(Dvgan& model, const std::string& text, DirectOptions options,
                                          const Direction& wanted, const GenerateOptions& how);

/// The frames that the constraints need for motions of a class that continue the priors: for a path without
/// times, as many as the model takes at its own pace.
std::size_t frames_needed(const ActionGan& model, const std::vector<ActionPrior>& priors, std::size_t label,
                          const Direction& wanted, std::uint64_t seed);

/// Directs motions that continue priors. They are placed where the path begins, or else at the origin.
std::vector<DirectedAction> make_directed(ActionGan& model, const std::vector<ActionPrior>& priors,
                                          const ActionSchedule& schedule, DirectOptions options,
                                          const Direction& wanted);

/// Prints how well motions meet what was asked for: for each of them its errors. Returns whether all do.
bool print_constraint_errors(const std::vector<std::vector<ConstraintError>>& made, double leg);

/// The constraints of a motion as marks on the page. Times count from `begin`, in seconds.
view::Marks marks_of(const std::vector<Constraint>& constraints, const motion::Motion& motion,
                     std::size_t root, double begin = 0);

}  // namespace motiongan::command
