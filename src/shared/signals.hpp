// Stopping where it is safe to.
#pragma once

namespace motiongan::command {

/// From here on Ctrl-C (and SIGTERM) asks to stop; a second one ends the process.
void catch_signals();
/// The signal that asked, or 0.
int caught_signal();

}  // namespace motiongan::command
