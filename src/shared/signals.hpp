// Signals as requests to stop at the next safe point, and standard output.
#pragma once

namespace motiongan::command {

/// From here on, SIGINT (Ctrl-C), SIGTERM, SIGHUP and SIGPIPE only request a stop; the next of the first
/// three ends the process. Signals that were ignored when the process started (nohup) stay ignored.
void catch_signals();

/// Whether a signal has requested a stop. Cheap enough to be called at every launch; call it often, for it
/// also takes back handlers that others have set.
bool stop_requested();

/// The signal that requested a stop, or 0.
int caught_signal();

/// Writes out what was printed. Throws Error if standard output cannot take it (a full disk).
void flush_output();

}  // namespace motiongan::command
