// Launches of functions of rows, cl/rows.cl.
#pragma once
#include "motiongan/core/context.hpp"

namespace motiongan::detail {

/// Enqueues kernel `name` of cl/rows.cl for `rows` rows of `length` elements. A row is the work of one item
/// or, in the wide form, of a work-group if it is long; that depends on nothing but its length, so that a row
/// alone equals the row among others, bit for bit.
template <class... Arguments>
void launch_rows(const Context& context, const char* name, std::size_t rows, std::size_t length,
                 const Arguments&... arguments) {
  constexpr std::size_t long_row = 32;  // elements; shorter ones leave most items of a group idle
  if (context.wide() && length >= long_row)
    context.launch("rows_wide", name, context.groups(rows), arguments...);
  else
    context.launch("rows", name, LaunchGrid::items(rows), arguments...);
}

}  // namespace motiongan::detail
