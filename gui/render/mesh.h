// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes, and those of the decoration around a scene, which is static and without contact.
#pragma once

#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// A triangle mesh in a frame of its own (m), with unit normals.
struct Mesh {
  std::vector<Vec3> position;
  std::vector<Vec3> normal;
  std::vector<Index3> triangle;  ///< counter-clockwise from outside
};

/// Unit normals of vertices: sums of the triangles' area vectors, in the triangles' order. A vertex
/// without area gets z.
[[nodiscard]] std::vector<Vec3> vertexNormals(const std::vector<Vec3>& position, const std::vector<Index3>& triangle);

/// From a frame whose z is up to W. @param down where gravity pulls in W, unit
[[nodiscard]] inline Quat upright(const Vec3& down) { return Quat::FromTwoVectors(-Vec3::UnitZ(), down); }

/// Adds triangles, two for each cell of a grid whose vertices the mesh has, row by row, and normals.
/// @param closed the last vertex of a row is joined to its first
void closeGrid(Mesh& mesh, int rows, int columns, bool closed);

/// A closed curve around a path: point k of n, counter-clockwise seen from the path's end.
using Ring = std::vector<Vec3>;

/// Skin over rings of equal size along a path, with smooth normals, and flat caps at both ends.
/// @pre at least two rings of at least three points
[[nodiscard]] Mesh loft(const std::vector<Ring>& rings);

/// n points of |x / a|^e + |y / b|^e = 1 around (centre.x, centre.y) in the plane z = centre.z; e = 2 is an ellipse,
/// larger values near a rectangle.
[[nodiscard]] Ring superellipse(const Vec3& centre, double a, double b, double e, int n);

/// A tube of circular section along a path of points (m). Sections stand across the path; ends are rounded.
/// @pre at least two points, none equal to its neighbour
[[nodiscard]] Mesh tube(const std::vector<Vec3>& path, double radius, int n);

/// Rigid motion of a mesh.
[[nodiscard]] Mesh moved(Mesh mesh, const Quat& rotation, const Vec3& translation);

/// A dome around organs and ports. It depends on rest positions and ports alone, so it stands still while
/// organs and camera move.
struct CavityShape {
  Vec3 centre = Vec3::Zero();  ///< p_W (m)
  double radius = 0.0;         ///< m
  bool operator==(const CavityShape&) const = default;
};
[[nodiscard]] CavityShape cavityShape(const SceneView& view);

/// The abdominal wall under pneumoperitoneum: the dome, gently uneven, seen from inside (normals point inward).
[[nodiscard]] Mesh makeCavity(const CavityShape& shape);

/// Tissue below the liver in the field: the greater omentum, a fatty apron, and on it the hepatic flexure of the
/// colon and the duodenum. Decoration: it stands still, and instruments pass through it.
struct Viscera {
  Mesh omentum;  ///< open, seen from above (normals point up)
  Mesh bowel;    ///< two closed tubes
};

/// All of it lies below `lowest`, so that it hides nothing above that from an endoscope which is above that, too.
/// @param vessels points of the walls of bile duct and artery at rest (m), which say where the liver's hilum is; none:
/// empty meshes @param lowest height (y) of the lowest point that may not be hidden (m)
[[nodiscard]] Viscera makeViscera(std::span<const Vec3> vessels, double lowest);

/// Abdominal wall, and where the scene has bile duct or hepatic artery, and y is up, their ligament, omentum and bowel.
struct Surroundings {
  Mesh wall, ligament;
  Viscera viscera;

  /// Rebuilds the meshes where the view's organs at rest are others than before.
  void update(const SceneView& view);
  /// The pose of a clip that was lost: on omentum, bowel or ligament, where they were in its way.
  [[nodiscard]] Pose restOf(const ClipView& clip, const Vec3& down) const;

 private:
  CavityShape shape_;
  std::vector<Vec3> vessels_;  ///< of which ligament and viscera were made
};

/// The hepatoduodenal ligament: the fold of peritoneum that bile duct and hepatic artery run along, from close behind
/// them down to the back of the cavity. Seen from above (normals point up). Decoration: it stands still, and
/// instruments pass through it.
/// @param vessels points of their walls at rest (m); none: an empty mesh
[[nodiscard]] Mesh makeLigament(std::span<const Vec3> vessels);

}  // namespace calot::gui
