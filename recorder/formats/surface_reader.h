// SPDX-License-Identifier: GPL-3.0-or-later
// The base of the readers of surface files; parseSurface() chooses one by the file's name.
#pragma once

#include <fmt/format.h>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/formats/surface_bytes.h"

namespace calot::recorder {

/// A file's remaining text, the surface read from it so far, and the place that messages name.
class SurfaceReader {
 public:
  SurfaceReader(std::string_view text, const std::string& name, LengthUnit unit, const SurfaceLimits& limits)
      : text_(text), name_(name), scale_(metres(unit)), limits_(limits) {}

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

  /// A coordinate in metres, of one in the file's unit.
  [[nodiscard]] double coordinate(double value) const {
    if (!std::isfinite(value)) fail("a coordinate that is not a finite number");
    const double length = value * scale_;
    if (!(std::abs(length) <= farthestCoordinate))
      fail(fmt::format("a coordinate of {} m: is the unit right?", length));
    return length;
  }

  /// A triangle of the face that stands at `at`. Its vertices may come later.
  void addTriangle(int a, int b, int c, std::size_t at) {
    if (mesh_.triangle.size() >= limits_.triangles) fail(fmt::format("more than {} triangles", limits_.triangles));
    mesh_.triangle.emplace_back(a, b, c);
    face_.push_back(at);
  }

  /// Checks that the vertices of all triangles are there.
  /// @param first number of the first vertex in this format
  void checkTriangles(std::string_view part, int first, const char* remark) {
    part_ = part;
    for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) {
      number_ = face_[t];
      for (const int vertex : mesh_.triangle[t]) {
        if (vertex < mesh_.vertices()) continue;
        fail(fmt::format("vertex {} is expected, but the file has {}{}", vertex + first, mesh_.vertices(), remark));
      }
    }
  }

  std::string_view text_;
  const std::string& name_;
  double scale_;
  const SurfaceLimits& limits_;
  TriangleMesh mesh_;
  std::vector<std::size_t> face_;   ///< of each triangle: where it stands
  std::string_view part_ = "line";  ///< with number_, the place that is being read
  std::size_t number_ = 0;
};

TriangleMesh readObj(const SurfaceReader& start);
TriangleMesh readStl(const SurfaceReader& start);
TriangleMesh readPly(const SurfaceReader& start);

}  // namespace calot::recorder
