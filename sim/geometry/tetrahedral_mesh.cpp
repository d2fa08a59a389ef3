// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <tuple>

#include "sim/geometry/isosurface_stuffing.h"
#include "sim/math/elementary.h"

namespace calot {
namespace {

/// Faces of a positive tetrahedron, seen counter-clockwise from outside; face k is opposite vertex k.
constexpr int faceVertices[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

struct Face {
  std::array<int, 3> sorted{};
  int tetrahedron = 0;
  int side = 0;
};

/// All faces, sorted so that those of one triangle are adjacent.
std::vector<Face> sortedFaces(const TetrahedralMesh& mesh) {
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tetrahedron.size());
  for (std::size_t t = 0; t < mesh.tetrahedron.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      Face face{{}, static_cast<int>(t), k};
      for (std::size_t j = 0; j < 3; ++j) face.sorted[j] = mesh.tetrahedron[t][faceVertices[k][j]];
      std::sort(face.sorted.begin(), face.sorted.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end(), [](const Face& x, const Face& y) {
    return std::tie(x.sorted, x.tetrahedron, x.side) < std::tie(y.sorted, y.tetrahedron, y.side);
  });
  return faces;
}

}  // namespace

double meshVolume(const TetrahedralMesh& mesh) {
  double six = 0.0;
  for (const Index4& v : mesh.tetrahedron) {
    const Vec3& a = mesh.vertex[slot(v[0])];
    six += (mesh.vertex[slot(v[1])] - a).cross(mesh.vertex[slot(v[2])] - a).dot(mesh.vertex[slot(v[3])] - a);
  }
  return six / 6.0;
}

DihedralRange dihedralRange(const TetrahedralMesh& mesh) {
  if (mesh.tetrahedron.empty()) return {};
  double smallest = 1e300;
  double largest = -1e300;
  for (const Index4& v : mesh.tetrahedron) {
    std::array<Vec3, 4> normal;
    for (int k = 0; k < 4; ++k) {
      const Vec3& a = mesh.vertex[slot(v[faceVertices[k][0]])];
      const Vec3& b = mesh.vertex[slot(v[faceVertices[k][1]])];
      const Vec3& c = mesh.vertex[slot(v[faceVertices[k][2]])];
      normal[slot(k)] = (b - a).cross(c - a);
    }
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i + 1; j < 4; ++j) {
        // Between outward normals: pi minus the angle inside.
        const double angle = arctangent2(normal[i].cross(normal[j]).norm(), -normal[i].dot(normal[j]));
        smallest = std::min(smallest, angle);
        largest = std::max(largest, angle);
      }
    }
  }
  return {smallest, largest};
}

std::vector<BoundaryTriangle> boundaryTriangles(const TetrahedralMesh& mesh) {
  const std::vector<Face> faces = sortedFaces(mesh);
  std::vector<BoundaryTriangle> boundary;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].sorted == faces[i].sorted) ++end;
    if (end - i == 1) {
      const Index4& v = mesh.tetrahedron[slot(faces[i].tetrahedron)];
      BoundaryTriangle triangle;
      triangle.tetrahedron = faces[i].tetrahedron;
      for (int j = 0; j < 3; ++j) triangle.vertex[j] = v[faceVertices[faces[i].side][j]];
      while (triangle.vertex[0] != faces[i].sorted[0]) {
        triangle.vertex = Index3(triangle.vertex[1], triangle.vertex[2], triangle.vertex[0]);
      }
      boundary.push_back(triangle);
    }
    i = end;
  }
  std::sort(boundary.begin(), boundary.end(), [](const BoundaryTriangle& x, const BoundaryTriangle& y) {
    return std::tie(x.vertex[0], x.vertex[1], x.vertex[2], x.tetrahedron) <
           std::tie(y.vertex[0], y.vertex[1], y.vertex[2], y.tetrahedron);
  });
  return boundary;
}

TriangleMesh boundarySurface(const TetrahedralMesh& mesh) {
  TriangleMesh surface;
  std::vector<int> number(mesh.vertex.size(), -1);
  const std::vector<BoundaryTriangle> boundary = boundaryTriangles(mesh);
  for (const BoundaryTriangle& t : boundary) {
    for (int k = 0; k < 3; ++k) number[slot(t.vertex[k])] = 0;
  }
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = surface.vertices();
    surface.vertex.push_back(mesh.vertex[i]);
  }
  for (const BoundaryTriangle& t : boundary) {
    surface.triangle.emplace_back(number[slot(t.vertex[0])], number[slot(t.vertex[1])], number[slot(t.vertex[2])]);
  }
  return surface;
}

std::vector<int> tetrahedronComponents(const TetrahedralMesh& mesh, int& count) {
  std::vector<int> parent(mesh.tetrahedron.size());
  for (std::size_t t = 0; t < parent.size(); ++t) parent[t] = static_cast<int>(t);
  const auto root = [&parent](int t) {
    while (parent[slot(t)] != t) t = parent[slot(t)] = parent[slot(parent[slot(t)])];
    return t;
  };
  const std::vector<Face> faces = sortedFaces(mesh);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].sorted != faces[i - 1].sorted) continue;
    const int x = root(faces[i - 1].tetrahedron);
    const int y = root(faces[i].tetrahedron);
    parent[slot(std::max(x, y))] = std::min(x, y);
  }
  count = 0;
  std::vector<int> component(parent.size(), -1);
  for (std::size_t t = 0; t < parent.size(); ++t) {
    const int r = root(static_cast<int>(t));
    if (r == static_cast<int>(t)) component[t] = count++;
    component[t] = component[slot(r)];
  }
  return component;
}

TetrahedralMesh subMesh(const TetrahedralMesh& mesh, const std::vector<std::uint8_t>& keep) {
  TetrahedralMesh result;
  std::vector<int> number(mesh.vertex.size(), -1);
  for (std::size_t t = 0; t < mesh.tetrahedron.size(); ++t) {
    if (keep[t] == 0) continue;
    result.tetrahedron.push_back(mesh.tetrahedron[t]);
    for (int k = 0; k < 4; ++k) number[slot(mesh.tetrahedron[t][k])] = 0;
  }
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = static_cast<int>(result.vertex.size());
    result.vertex.push_back(mesh.vertex[i]);
  }
  for (Index4& v : result.tetrahedron) {
    for (int k = 0; k < 4; ++k) v[k] = number[slot(v[k])];
  }
  return result;
}

}  // namespace calot
