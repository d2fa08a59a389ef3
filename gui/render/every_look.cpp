// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/every_look.h"

namespace calot::gui {

SceneView everyLook() {
  SceneView view;
  for (const char* look : {"liver", "gallbladder", "duct", "artery", "fat"}) {
    SurfaceView& surface = view.surface.emplace_back();
    surface.appearance = look;
    surface.position = surface.rest = {Vec3(-0.01, -0.01, 0.1), Vec3(0.01, -0.01, 0.1), Vec3(0.0, 0.01, 0.1)};
    surface.triangle = {Index3(0, 1, 2), Index3(0, 2, 1)};
  }
  ConnectiveView& bed = view.connective.emplace_back();
  bed.strand = {{Vec3(0.0, 0.0, 0.09), Vec3(0.0, 0.01, 0.09)}, {Vec3(0.01, 0.0, 0.09), Vec3(0.01, 0.01, 0.09)}};
  bed.condition = {StrandCondition::attached, StrandCondition::attached};
  bed.alpha = {1.0F, 1.0F};
  bed.sheet = {{0, 1}};
  view.instrument[0].kind = InstrumentKind::grasper;
  view.instrument[1].kind = InstrumentKind::hook;
  for (InstrumentView& instrument : view.instrument) {
    instrument.pose.position = Vec3(0.0, 0.0, 0.1);
    instrument.port = Vec3(0.0, 0.1, 0.1);
  }
  return view;
}

}  // namespace calot::gui
