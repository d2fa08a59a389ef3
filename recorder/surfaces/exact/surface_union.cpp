// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/surfaces/surface_union.h"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <cstdint>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using ExactMesh = CGAL::Surface_mesh<Kernel::Point_3>;

ExactMesh exact(const TriangleMesh& piece) {
  ExactMesh mesh;
  std::vector<ExactMesh::Vertex_index> vertex;
  vertex.reserve(piece.vertex.size());
  for (const Vec3& p : piece.vertex) vertex.push_back(mesh.add_vertex(Kernel::Point_3(p[0], p[1], p[2])));
  for (const Index3& t : piece.triangle) {
    if (mesh.add_face(vertex[slot(t[0])], vertex[slot(t[1])], vertex[slot(t[2])]) == ExactMesh::null_face())
      throw Error(ErrorKind::refused, "one of them touches itself");
  }
  if (CGAL::Polygon_mesh_processing::does_self_intersect(mesh))
    throw Error(ErrorKind::refused, "one of them crosses itself");
  return mesh;
}

}  // namespace

TriangleMesh uniteSurfaces(const std::vector<TriangleMesh>& piece) {
  ExactMesh whole = exact(piece.front());
  for (std::size_t i = 1; i < piece.size(); ++i) {
    ExactMesh next = exact(piece[i]);
    if (!CGAL::Polygon_mesh_processing::corefine_and_compute_union(whole, next, whole))
      throw Error(ErrorKind::refused, "they touch along an edge, too");
  }
  whole.collect_garbage();
  TriangleMesh united;
  for (const auto v : whole.vertices()) {
    const auto& p = whole.point(v);
    united.vertex.emplace_back(CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z()));
  }
  for (const auto f : whole.faces()) {
    Index3 corner = Index3::Zero();
    int k = 0;
    for (const auto v : CGAL::vertices_around_face(whole.halfedge(f), whole))
      corner[k++] = static_cast<int>(static_cast<std::uint32_t>(v));
    united.triangle.push_back(corner);
  }
  return united;
}

}  // namespace calot::recorder
