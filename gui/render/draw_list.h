// SPDX-License-Identifier: GPL-3.0-or-later
// Blood or bile from a vessel that is parted and not closed: a visual hint, not a simulation. State contains neither
// fluids nor the time since parting; drop and stain depend on the view alone.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "gui/render/mesh.h"
#include "gui/render/translucent.h"
#include "sim/math/linear.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// The face of a parted vessel that no clip closes.
struct OpenEnd {
  Vec3 position = Vec3::Zero();   ///< middle of the face in W (m)
  Vec3 outwards = Vec3::UnitZ();  ///< unit, away from the stump
  double radius = 0.0;            ///< of the face (m)
  Vec3 down = -Vec3::UnitZ();     ///< where it runs to, unit
  bool bile = false;              ///< leaves a cystic or bile duct; blood leaves any other vessel
};

/// All open faces, by SurfaceView::face. @pre checkView(view) has passed
[[nodiscard]] std::vector<OpenEnd> openEnds(const SceneView& view);

/// A drop that grows at the face for a few seconds, falls, and forms again. In the axes of W, about the middle of the
/// face.
/// @param time of the view (s)
[[nodiscard]] Mesh makeDrop(const OpenEnd& end, double time);

/// Stain at a point below the face, 0 to 1. What wells up runs down in waves.
/// @param p_W the point (m) @param time of the view (s)
[[nodiscard]] double stainAt(const OpenEnd& end, const Vec3& p_W, double time);

/// Centre of the light source beside the lens, in C (m).
inline constexpr float lightX = 0.0045F, lightY = -0.0050F;

/// Visible part of a picture: all of it, or the round field of an endoscope.
struct Sight {
  double aside = 1.0, up = 1.0;      ///< of what is seen, |x| <= aside z and |y| <= up z in C
  float rim = 0.0F;                  ///< radius of the round field (pixels); 0: no field
  float feather = 0.0F;              ///< half the width of its soft edge (pixels)
  float halfX = 0.0F, halfY = 0.0F;  ///< half axes of the polygon around it (clip coordinates); 0: no field

  /// Tangent of the half width of the light's field.
  [[nodiscard]] double lit() const;
};

/// Number of sides of the polygon that approximates the round field.
inline constexpr int fieldSides = 96;

/// @param width, height of the picture (pixels) @param field is there a round field?
[[nodiscard]] Sight sightOf(int width, int height, double verticalFieldOfView, bool field);

/// Bits of placeIn().
struct Place {
  static constexpr std::uint8_t sides = 0x1F;  ///< beyond which of the five sides: left, right, above, below, behind
  static constexpr std::uint8_t edge = 0x20;   ///< not well within
};

/// Position of a point of C relative to the visible part. If all points of a set share a side, their convex hull is
/// invisible beyond it, and so are its shadows.
/// @return bits of Place
[[nodiscard]] std::uint8_t placeIn(const Sight& sight, const Vec3& p_C);

/// Does a triangle of a closed body face away from both lens and light?
/// @param a, b, c counter-clockwise from outside
[[nodiscard]] bool turnedAway(const Vec3& a, const Vec3& b, const Vec3& c);

/// Does every side of every triangle have an opposite side in another triangle? Then the surface bounds a body whose
/// inner side is never visible from outside.
/// @param triangle @pre no negative index
[[nodiscard]] bool isClosed(const std::vector<Index3>& triangle);

/// Data of a surface reused between pictures while its reference shape and triangles stay unchanged.
struct SurfaceForm {
  std::vector<Vec3> rest, restNormal;
  std::vector<Index3> triangle;
  bool closed = false;

  /// Computes the members unless they are up to date for this surface.
  void update(const SurfaceView& surface);
};

/// Appearances known to the shader. Their numbers are LOOK in shaders/surfaceMaterial.glsl.
enum class Appearance : int {
  tissue = 0,
  liver = 1,
  gallbladder = 2,
  cavity = 3,  ///< abdominal wall around the scene
  duct = 4,
  artery = 5,
  fat = 6,
  omentum = 7,
  bowel = 8,
  insulation = 10,  ///< black sleeve of a shaft
  steel = 11,
  ceramic = 12,
  titanium = 13,  ///< clips
  blood = 14,
  bile = 15,
};

/// Decoration around the scene: drawn behind all else, and without a shadow of its own.
[[nodiscard]] constexpr bool isSurroundings(Appearance a) {
  return a == Appearance::cavity || a == Appearance::omentum || a == Appearance::bowel;
}

/// From SurfaceView::appearance; unknown words are drawn as plain tissue.
[[nodiscard]] Appearance appearanceOf(const std::string& word);

/// A vertex as the graphics side sees it, in the camera's frame C (x right, y down, z forward).
struct DrawVertex {
  float position[3];
  float normal[3];
  float rest[3];  ///< texture coordinates: reference position in W, or position in the instrument's frame (m)
  float restNormal[3];
  float charred;  ///< SurfaceView::charred
  float face;     ///< SurfaceView::face, or stain by an open vessel: blood above 0, bile below
};

struct DrawPart {
  Appearance appearance = Appearance::tissue;
  bool harmed = false;    ///< charred or parted somewhere
  bool oneSided = false;  ///< a closed body, seen from outside alone, or the cavity, seen from inside alone
  std::uint32_t firstIndex = 0;
  std::uint32_t indexCount = 0;
};

/// Everything needed for one picture, ready for upload.
struct DrawList {
  std::vector<DrawVertex> vertex;
  std::vector<std::uint32_t> index;
  std::vector<DrawPart> part;      ///< none empty; in drawing order: probably nearest first
  SheetList sheets;                ///< connective tissue, blended over the parts
  SmokeList smoke;                 ///< blended over all
  float referenceDistance = 0.1F;  ///< distance at which the endoscope's exposure is right (m)
};

/// Builds successive draw lists and reuses what does not change between them: rest normals, the surroundings, memory. A
/// list depends on its view alone.
class DrawListMaker {
 public:
  /// The list is valid until the next call. @pre checkView(view) has passed
  [[nodiscard]] const DrawList& make(const SceneView& view, const Sight& sight, bool surroundings,
                                     std::span<const Puff> smoke = {});

 private:
  void addSurface(const SurfaceView& surface, SurfaceForm& form, std::span<const OpenEnd> open, double time);
  void addMesh(const Mesh& mesh, Appearance appearance, const Pose& pose = {}, bool lengthwise = false);

  void begin() { base_ = static_cast<std::uint32_t>(list_.vertex.size()); }
  [[nodiscard]] Vec3 point(const Vec3& p_W) const { return toCamera_ * (p_W - origin_); }
  [[nodiscard]] Vec3 direction(const Vec3& d_W) const { return toCamera_ * d_W; }
  void addVertex(const Vec3& p_C, const Vec3& n_C, const Vec3& rest, const Vec3& restNormal, float charred = 0.0F,
                 float face = 0.0F);
  /// Culls what is invisible; triangles at the picture's edge come last, since clipping takes longer.
  void addPart(DrawPart part, const std::vector<Index3>& triangles);

  DrawList list_;
  std::vector<SurfaceForm> form_;  ///< per surface of the view
  Surroundings surroundings_;
  Sight sight_;
  std::vector<std::uint8_t> place_;  ///< per vertex: placeIn()
  std::vector<std::uint32_t> cut_;   ///< triangles at the edge of the picture
  Vec3 origin_ = Vec3::Zero();
  Mat3 toCamera_ = Mat3::Identity();
  std::uint32_t base_ = 0;  ///< of the vertices that are being added
};

}  // namespace calot::gui
