// What the shipped models make of some of their descriptions and classes; the demo begins with it.
#pragma once
#include "motiongan/core/context.hpp"
#include "shared/command.hpp"

namespace motiongan::command {

/// Writes twelve motions of the shipped models to `out`: shipped/NAME.bvh, a page and a picture. Says so and
/// does nothing if there is none.
void show_shipped_motions(const Context& context, const fs::path& out);

}  // namespace motiongan::command
