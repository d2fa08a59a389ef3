// SPDX-License-Identifier: GPL-3.0-or-later
// Everything that a renderer sees: surfaces, instruments, camera; never the State behind them.
#pragma once

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "sim/scene/samples.h"
#include "sim/tissue/structure_role.h"
#include "sim/tissue/tissues.h"

namespace calot {

/// One structure's outer surface, in W. Built only when an observer asks for it.
struct SurfaceView {
  std::string organ;       ///< name in the scene: "liver", "cystic_duct"
  std::string appearance;  ///< "liver", "gallbladder", "duct", "artery", ...: which look the renderer gives it
  StructureRole role = StructureRole::other;
  std::vector<Vec3> position;    ///< deformed vertices (m)
  std::vector<Vec3> rest;        ///< the same vertices at rest, for textures that stick to the tissue
  std::vector<Index3> triangle;  ///< outward (counter-clockwise from outside)
  std::vector<float> charred;    ///< per vertex: 0 not at all, 1 as it counts as charred, more beyond; empty: nowhere
  /// Per vertex: 0 on the skin; where a vessel is parted 1 at the face's rim to 2 (open; 1.5 clipped) in its middle.
  std::vector<float> face;
};

struct InstrumentView {
  InstrumentKind kind = InstrumentKind::none;
  Pose pose;                 ///< simulated pose in W
  Vec3 port = Vec3::Zero();  ///< where the shaft passes the abdominal wall, in W (m)
  double radius = 0.0025;    ///< of the shaft (m)
  double jaw = 0.0;          ///< rad
  bool touching = false;
};

struct SceneView {
  std::uint64_t step = 0;
  double time = 0.0;  ///< since the attempt's start (s)
  std::vector<SurfaceView> surface;
  std::vector<ConnectiveView> connective;
  std::vector<ClipView> clip;
  std::array<InstrumentView, handCount> instrument;
  CameraSample camera;
  double verticalFieldOfView = 1.0;  ///< rad
  Vec3 down = -Vec3::UnitY();        ///< where gravity pulls, unit; of a scene without gravity -y, as scenes are drawn
};

/// SceneView::down of a scene with this gravity (m/s^2): its direction, or the view's default where there is none.
inline Vec3 downOf(const Vec3& gravity) {
  const double strength = gravity.norm();
  return std::isfinite(strength) && strength > 0.0 ? Vec3(gravity / strength) : SceneView().down;
}

}  // namespace calot
