// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/tables.h"

extern "C" const calot::apps::Module* calotModule() {
  using namespace calot::recorder;
  static constexpr calot::apps::DeviceModule table{
      {CALOT_MODULE_BUILD}, openGamepad,    listGamepads,   openSpaceMouse,  openHaply,       openOpenIgtLink,
      serveOpenIgtLink,     openFilmSource, openLiveCamera, listLiveCameras, makeTagDetector, tagCells};
  return &table;
}
