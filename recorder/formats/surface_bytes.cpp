// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_bytes.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>
#include <string_view>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {

double metres(LengthUnit unit) {
  constexpr double lengths[] = {1.0, 0.01, 0.001};
  return lengths[static_cast<std::size_t>(unit)];
}

const FieldWords& lengthUnits() {
  static const FieldWords units{{"m", 0}, {"cm", 1}, {"mm", 2}};
  return units;
}

LengthUnit parseLengthUnit(const std::string& word) {
  for (const auto& [known, number] : lengthUnits()) {
    if (known == word) return static_cast<LengthUnit>(number);
  }
  throw Error(ErrorKind::invalid, fmt::format("unit \"{}\": m, cm or mm is expected", shown(word)));
}

namespace {

enum class Format { none, obj, stl, ply };

Format formatOf(const std::string& name) {
  const std::string end = lowerCase(std::string_view(name).substr(name.size() < 4 ? 0 : name.size() - 4));
  if (end == ".obj") return Format::obj;
  if (end == ".stl") return Format::stl;
  if (end == ".ply") return Format::ply;
  return Format::none;
}

}  // namespace

bool isSurfaceName(const std::string& name) { return formatOf(name) != Format::none; }

TriangleMesh parseSurface(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                          const SurfaceLimits& limits) {
  switch (formatOf(name)) {
    case Format::obj:
      return parseObj(bytes, name, unit, limits);
    case Format::stl:
      return parseStl(bytes, name, unit, limits);
    case Format::ply:
      return parsePly(bytes, name, unit, limits);
    case Format::none:
      break;
  }
  throw Error(ErrorKind::damaged, Where{name}, "surfaces are read from .obj, .stl and .ply files");
}

namespace {

constexpr std::array<std::string_view, 17> passedOver = {"vt",     "vn",     "vp",       "g",      "o",       "s",
                                                         "usemtl", "mtllib", "l",        "p",      "mg",      "lod",
                                                         "bevel",  "usemap", "c_interp", "maplib", "d_interp"};

class ObjParser {
 public:
  ObjParser(const std::string& name, LengthUnit unit, const SurfaceLimits& limits)
      : name_(name), scale_(metres(unit)), limits_(limits) {}

  TriangleMesh parse(std::string_view text) {
    while (!text.empty()) {
      ++line_;
      readLine(takeLine(text));
    }
    // A positive index may name a vertex that comes later.
    for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (mesh_.triangle[t][k] < mesh_.vertices()) continue;
        line_ = triangleLine_[t];
        fail(fmt::format("vertex {} is expected, but the file has {}", mesh_.triangle[t][k] + 1, mesh_.vertices()));
      }
    }
    if (mesh_.vertex.empty())
      throw Error(ErrorKind::damaged, Where{name_}, "no vertex; not an OBJ file, or an empty one");
    if (mesh_.triangle.empty())
      throw Error(ErrorKind::damaged, Where{name_}, "vertices but no face; a surface is expected");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::damaged, Where{name_, fmt::format("line {}", line_)}, what);
  }

  void readLine(std::string_view line) {
    if (line.find('\0') != std::string_view::npos) fail("a zero byte; this is not a text file");
    Words words(line, '#');
    const std::string_view keyword = words.next();
    if (keyword.empty()) return;
    if (line.back() == '\\' || (line.size() > 1 && line.back() == '\r' && line[line.size() - 2] == '\\')) {
      fail("a line continued with \\ is not understood; join the lines");
    }
    if (keyword == "v") {
      readVertex(words);
    } else if (keyword == "f") {
      readFace(words);
    } else if (std::find(passedOver.begin(), passedOver.end(), keyword) == passedOver.end()) {
      fail(fmt::format("\"{}\" is not a keyword of a polygonal OBJ file", shown(keyword)));
    }
  }

  double readNumber(std::string_view word) const {
    std::string fault;
    const double value = readFiniteNumber(word, fault);
    if (!fault.empty()) fail(fault);
    return value;
  }

  void readVertex(Words& words) {
    if (mesh_.vertex.size() >= limits_.vertices) fail(fmt::format("more than {} vertices", limits_.vertices));
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = words.next();
      if (word.empty()) fail(fmt::format("a vertex with {} of 3 coordinates", k));
      p[k] = readNumber(word) * scale_;
      if (!(std::abs(p[k]) <= farthestCoordinate)) fail(fmt::format("a coordinate of {} m: is the unit right?", p[k]));
    }
    // A weight or a colour may follow.
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) static_cast<void>(readNumber(word));
    mesh_.vertex.push_back(p);
  }

  /// One index of "v/vt/vn". @return it from 0
  int readIndex(std::string_view word, bool isVertex) const {
    int value = 0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault != std::errc() || end != word.data() + word.size())
      fail(fmt::format("\"{}\" is not an index", shown(word)));
    if (value == 0) fail("index 0: OBJ counts from 1");
    if (!isVertex || value > 0) return value - 1;
    const int counted = mesh_.vertices() + value;
    if (counted < 0) fail(fmt::format("index {} reaches before the first of {} vertices", value, mesh_.vertices()));
    return counted;
  }

  int readCorner(std::string_view word) const {
    const std::size_t slash = word.find('/');
    const int vertex = readIndex(word.substr(0, slash), true);
    if (slash == std::string_view::npos) return vertex;
    const std::string_view rest = word.substr(slash + 1);
    const std::size_t second = rest.find('/');
    const std::string_view texture = rest.substr(0, second);
    if (!texture.empty() || second == std::string_view::npos) static_cast<void>(readIndex(texture, false));
    if (second != std::string_view::npos) static_cast<void>(readIndex(rest.substr(second + 1), false));
    return vertex;
  }

  void readFace(Words& words) {
    face_.clear();
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) face_.push_back(readCorner(word));
    if (face_.size() < 3) fail(fmt::format("a face with {} corners", face_.size()));
    for (std::size_t k = 2; k < face_.size(); ++k) {
      if (mesh_.triangle.size() >= limits_.triangles) fail(fmt::format("more than {} triangles", limits_.triangles));
      mesh_.triangle.emplace_back(face_[0], face_[k - 1], face_[k]);
      triangleLine_.push_back(line_);
    }
  }

  const std::string& name_;
  double scale_;
  SurfaceLimits limits_;
  TriangleMesh mesh_;
  std::vector<std::size_t> triangleLine_;
  std::vector<int> face_;
  std::size_t line_ = 0;
};

}  // namespace

TriangleMesh parseObj(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const SurfaceLimits& limits) {
  if (bytes.size() > limits.bytes) {
    throw Error(ErrorKind::damaged, Where{name}, fmt::format("larger than {} bytes", limits.bytes));
  }
  return ObjParser(name, unit, limits).parse({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string formatObj(const TriangleMesh& mesh, const std::string& comment) {
  std::string text;
  text.reserve(64 * mesh.vertex.size() + 24 * mesh.triangle.size() + 1024);
  const auto out = std::back_inserter(text);
  for (std::string_view rest = comment; !rest.empty();) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    fmt::format_to(out, "# {}\n", rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  for (const Vec3& p : mesh.vertex) fmt::format_to(out, "v {} {} {}\n", p[0], p[1], p[2]);
  for (const Index3& v : mesh.triangle) fmt::format_to(out, "f {} {} {}\n", v[0] + 1, v[1] + 1, v[2] + 1);
  return text;
}

}  // namespace calot::recorder
