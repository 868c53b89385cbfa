// Ctrl-C and SIGTERM as requests to stop at the next safe point.
#pragma once

namespace motiongan::command {

/// From here on, Ctrl-C and SIGTERM only request a stop; a second one ends the process.
void catch_signals();
/// The signal that requested a stop, or 0.
int caught_signal();

}  // namespace motiongan::command
