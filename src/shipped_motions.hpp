// What the shipped models make of some of their descriptions; the demo begins with it.
#pragma once
#include "motiongan/core/context.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Writes twelve motions of the shipped models that take a text to `out`: shipped/NAME.bvh, a page and a
/// picture. Says so and does nothing if there is no such model.
void show_shipped_motions(const Context& context, const fs::path& out);

}  // namespace motiongan::command
