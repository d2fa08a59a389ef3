// SPDX-License-Identifier: GPL-3.0-or-later
// What is drawn and what is felt are the same instrument.
#include <gtest/gtest.h>

#include <algorithm>

#include "gui/render/instrument_mesh.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/instruments.h"
#include "tests/sim/instruments/support/shape_distance.h"

namespace calot::gui {
namespace {

TEST(InstrumentAgreement, PictureAndContactShapeLieTogether) {
  constexpr double length = 0.15;
  for (const InstrumentDefinition* instrument : instruments()) {
    SCOPED_TRACE(instrument->name);
    const InstrumentKind kind = instrument->kind;
    for (const double jaw : {0.0, 0.5, 1.2}) {
      InstrumentView view;
      view.kind = kind;
      view.jaw = jaw;
      view.radius = 0.0025;
      view.pose = Pose{};
      view.port = Vec3(0.0, 0.0, -length);
      const InstrumentShape shape = instrumentShape(kind, jaw, view.radius, length);
      double farthest = 0.0;  // of what is drawn outside the contact shape
      Box drawn;
      for (const InstrumentPart& part : makeInstrument(view)) {
        if (part.appearance == Appearance::titanium) continue;  // the loaded clip
        for (const Vec3& p : part.mesh.position) {
          if (p[2] < -length) continue;
          farthest = std::max(farthest, calot::test::distanceTo(shape, p));
          drawn.include(p);
        }
      }
      Box felt;
      for (const Capsule& c : shape.capsules()) {
        for (const Vec3& p : {c.p0, c.p1}) {
          Box ball;
          ball.include(p);
          ball.grow(c.radius);
          felt.include(ball.lower);
          felt.include(ball.upper);
        }
      }
      EXPECT_LT(farthest, 0.0009) << jaw;
      EXPECT_LT((drawn.lower - felt.lower).head<2>().cwiseAbs().maxCoeff(), 0.0008);
      EXPECT_LT((drawn.upper - felt.upper).cwiseAbs().maxCoeff(), 0.0008);
    }
  }
}

}  // namespace
}  // namespace calot::gui
