// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "gui/render/sheet_list.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// Looks that the shader knows. The numbers stand in shader_material.cpp.
enum class Appearance : int {
  tissue = 0,
  liver = 1,
  gallbladder = 2,
  cavity = 3,  ///< abdominal wall around the scene
  duct = 4,
  artery = 5,
  fat = 6,
  insulation = 10,  ///< black sleeve of a shaft
  steel = 11,
  ceramic = 12,
  titanium = 13,  ///< clips
};

/// From SurfaceView::appearance; a word that is not known here is drawn as plain tissue.
[[nodiscard]] Appearance appearanceOf(const std::string& word);

/// A triangle mesh in a frame of its own (m), with unit normals.
struct Mesh {
  std::vector<Vec3> position;
  std::vector<Vec3> normal;
  std::vector<Index3> triangle;  ///< counter-clockwise from outside
};

/// Unit normals of vertices: sums of the triangles' area vectors, in the triangles' order. A vertex without area gets
/// z.
[[nodiscard]] std::vector<Vec3> vertexNormals(const std::vector<Vec3>& position, const std::vector<Index3>& triangle);

/// A vertex as the graphics side sees it, in the camera's frame C (x right, y down, z forward).
struct DrawVertex {
  float position[3];
  float normal[3];
  float rest[3];  ///< where textures stick: rest position in W, or position in the instrument's frame (m)
  float restNormal[3];
  float charred;  ///< SurfaceView::charred
  float face;     ///< SurfaceView::face
};

struct DrawPart {
  Appearance appearance = Appearance::tissue;
  bool harmed = false;  ///< charred or parted somewhere
  std::uint32_t firstIndex = 0;
  std::uint32_t indexCount = 0;
};

/// Everything of one picture, ready to be uploaded.
struct DrawList {
  std::vector<DrawVertex> vertex;
  std::vector<std::uint32_t> index;
  std::vector<DrawPart> part;      ///< the cavity, if any, last
  SheetList sheets;                ///< connective tissue, blended over the parts
  float referenceDistance = 0.1F;  ///< distance at which the endoscope's exposure is right (m)
};

/// @pre checkView(view) has passed
[[nodiscard]] DrawList makeDrawList(const SceneView& view, bool cavity);

}  // namespace calot::gui
