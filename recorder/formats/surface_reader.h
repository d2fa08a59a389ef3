// SPDX-License-Identifier: GPL-3.0-or-later
// The base of the readers of surface files; parseSurface() chooses one by the file's name.
#pragma once

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/formats/polygon.h"
#include "recorder/formats/surface_bytes.h"

namespace calot::recorder {

/// A file's remaining text, the surface read from it so far, and the place that messages name.
class SurfaceReader {
 public:
  /// @param[in,out] notes what is done to the surface is added
  SurfaceReader(std::string_view text, const std::string& name, LengthUnit unit, const SurfaceLimits& limits,
                std::vector<std::string>& notes)
      : text_(text), name_(name), scale_(metres(unit)), limits_(limits), notes_(notes) {}

  /// The file as a whole is wrong. @throws Error (damaged)
  [[noreturn]] void failFile(const std::string& what) const { throw Error(ErrorKind::damaged, Where{name_}, what); }

 protected:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::damaged, Where{name_, fmt::format("{} {}", part_, number_)}, what);
  }

  /// The next line.
  std::string_view nextLine(const char* zeroByte = "a zero byte; this is not a text file") {
    ++number_;
    const std::string_view line = takeLine(text_);
    if (line.find('\0') != std::string_view::npos) fail(zeroByte);
    return line;
  }

  [[nodiscard]] double finiteNumber(std::string_view word) const {
    std::string fault;
    const double value = readFiniteNumber(word, fault);
    if (!fault.empty()) fail(fault);
    return value;
  }

  void passByteOrderMark() {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  }

  /// A coordinate in metres, of one in the file's unit.
  [[nodiscard]] double coordinate(double value) const {
    if (!std::isfinite(value)) fail("a coordinate that is not a finite number");
    return value * scale_;
  }

  /// A point that triangles use. @throws Error where it is too far
  void checkPoint(const Vec3& p) const {
    const double length = p.cwiseAbs().maxCoeff();
    if (!(length <= farthestCoordinate)) fail(fmt::format("a coordinate of {} m: is the unit right?", length));
  }

  /// A vertex that may be used or not: exporters leave some at any place.
  void addVertex(const Vec3& p) {
    if (mesh_.vertex.size() >= limits_.vertices) fail(fmt::format("more than {} vertices", limits_.vertices));
    if (!(p.cwiseAbs().maxCoeff() <= farthestCoordinate)) far_.push_back({mesh_.vertices(), part_, number_});
    mesh_.vertex.push_back(p);
  }

  /// A triangle of the face that stands at `at`. Its vertices may come later.
  void addTriangle(int a, int b, int c, std::size_t at) {
    if (mesh_.triangle.size() >= limits_.triangles) fail(fmt::format("more than {} triangles", limits_.triangles));
    mesh_.triangle.emplace_back(a, b, c);
    face_.push_back(at);
  }

  /// The surface, when vertices and triangles, polygons as fans, were added: concave polygons are cut again, vertices
  /// that are too far and in no triangle dropped. @throws Error where a triangle's vertex is missing or too far
  /// @param part what faces are called
  /// @param first number of the first vertex in this format
  TriangleMesh finish(std::string_view part, int first, const char* remark) {
    part_ = part;
    for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) {
      number_ = face_[t];
      for (const int vertex : mesh_.triangle[t]) {
        if (vertex < mesh_.vertices()) continue;
        fail(fmt::format("vertex {} is expected, but the file has {}{}", vertex + first, mesh_.vertices(), remark));
      }
    }
    cutPolygons();
    if (!far_.empty()) dropFarVertices();
    return std::move(mesh_);
  }

 private:
  void cutPolygons() {
    std::size_t crossing = 0;
    double work = 0.0;
    for (std::size_t t = 0, end = 0; t < face_.size(); t = end) {
      while (end < face_.size() && face_[end] == face_[t]) ++end;
      const std::span<Index3> fan = std::span(mesh_.triangle).subspan(t, end - t);
      number_ = face_[t];
      if (!fanFolds(mesh_.vertex, fan)) continue;
      const auto corners = static_cast<double>(fan.size() + 2);
      work += corners * corners;
      if (work > maxConcaveWork) {
        fail(
            fmt::format("a face of {} corners: concave faces have too many of them in all; triangulate the surface "
                        "where it comes from",
                        corners));
      }
      crossing += cutPolygon(mesh_.vertex, fan) == PolygonCut::crossing ? 1 : 0;
    }
    if (crossing > 0) notes_.push_back(fmt::format("{} polygons cross themselves: they were cut into fans", crossing));
  }

  void dropFarVertices() {
    std::vector<char> used(mesh_.vertex.size(), 0);
    for (const Index3& t : mesh_.triangle) {
      for (const int v : t) used[slot(v)] = 1;
    }
    for (const FarVertex& v : far_) {
      part_ = v.part;
      number_ = v.number;
      if (used[slot(v.vertex)] != 0) checkPoint(mesh_.vertex[slot(v.vertex)]);
    }
    const int dropped = dropUnusedVertices(mesh_);
    notes_.push_back(fmt::format("vertices that no face uses were dropped: {}, of them farther than {} m: {}", dropped,
                                 farthestCoordinate, far_.size()));
  }

  struct FarVertex {
    int vertex;
    std::string_view part;
    std::size_t number;
  };
  std::vector<FarVertex> far_;     ///< farther than farthestCoordinate
  std::vector<std::size_t> face_;  ///< of each triangle: where it stands

 protected:
  std::string_view text_;
  const std::string& name_;
  double scale_;
  const SurfaceLimits& limits_;
  std::vector<std::string>& notes_;
  TriangleMesh mesh_;
  std::string_view part_ = "line";  ///< with number_, the place that is being read
  std::size_t number_ = 0;
};

TriangleMesh readObj(const SurfaceReader& start);
TriangleMesh readStl(const SurfaceReader& start);
TriangleMesh readPly(const SurfaceReader& start);
TriangleMesh readOff(const SurfaceReader& start);

}  // namespace calot::recorder
