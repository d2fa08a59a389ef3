// SPDX-License-Identifier: GPL-3.0-or-later
// One field of what a step reports. Each part of StepResult lists its fields once, by pointers to its members:
//
//   template <class Visit> static void fields(Visit&& visit) {
//     visit(ResultField{"volume", "m^3", "", 1, "of the deformed tetrahedra"}, &OrganResult::volume);
//   }
//
// The recording's columns, schemas/observables.md, comparison, equality and tests all run over that list.
#pragma once

#include <cstdint>

namespace calot {

struct ResultField {
  const char* name;     ///< of the data set; stored, never reused
  const char* unit;     ///< of its numbers; "1": a share or ratio; "": none
  const char* frame;    ///< of a vector or rotation, "p_WI"; "": none
  std::uint32_t since;  ///< version of StepResult that brought it
  const char* meaning;  ///< one line, for schemas/observables.md
};

/// The fields of one kind of part, and the group of a recording that holds them.
struct ResultGroup {
  const char* path;     ///< "/observables/organs"
  std::uint32_t since;  ///< version of StepResult that brought the group
  const char* meaning;
};

}  // namespace calot
