// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/tables.h"

extern "C" const calot::apps::Module* calotModule() {
  static constexpr calot::apps::SurfaceModule table{{CALOT_MODULE_BUILD}, calot::recorder::uniteSurfaces};
  return &table;
}
