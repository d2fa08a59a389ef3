// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_bytes.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/formats/surface_reader.h"

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

using Reader = TriangleMesh (*)(const SurfaceReader& start);

/// Reader for the format that the name's end states, or null.
Reader readerOf(const std::string& name) {
  constexpr std::pair<std::string_view, Reader> readers[] = {{".obj", readObj}, {".stl", readStl}, {".ply", readPly}};
  const std::string end = lowerCase(std::string_view(name).substr(name.size() < 4 ? 0 : name.size() - 4));
  for (const auto& [ending, reader] : readers) {
    if (end == ending) return reader;
  }
  return nullptr;
}

}  // namespace

bool isSurfaceName(const std::string& name) { return readerOf(name) != nullptr; }

TriangleMesh parseSurface(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                          const SurfaceLimits& limits) {
  const SurfaceReader start({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name, unit, limits);
  const Reader read = readerOf(name);
  if (read == nullptr) start.failFile("surfaces are read from .obj, .stl and .ply files");
  if (bytes.size() > limits.bytes) start.failFile(fmt::format("larger than {} bytes", limits.bytes));
  return read(start);
}

namespace {

constexpr std::array<std::string_view, 17> passedOver = {"vt",     "vn",     "vp",       "g",      "o",       "s",
                                                         "usemtl", "mtllib", "l",        "p",      "mg",      "lod",
                                                         "bevel",  "usemap", "c_interp", "maplib", "d_interp"};

class ObjReader : public SurfaceReader {
 public:
  explicit ObjReader(const SurfaceReader& start) : SurfaceReader(start) {}

  TriangleMesh read() {
    while (!text_.empty()) readLine(nextLine());
    checkTriangles("line", 1, "");
    if (mesh_.vertex.empty()) failFile("no vertex; not an OBJ file, or an empty one");
    if (mesh_.triangle.empty()) failFile("vertices but no face; a surface is expected");
    return std::move(mesh_);
  }

 private:
  void readLine(std::string_view line) {
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

  void readVertex(Words& words) {
    if (mesh_.vertex.size() >= limits_.vertices) fail(fmt::format("more than {} vertices", limits_.vertices));
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = words.next();
      if (word.empty()) fail(fmt::format("a vertex with {} of 3 coordinates", k));
      p[k] = coordinate(finiteNumber(word));
    }
    // A weight or a colour may follow.
    for (std::string_view word = words.next(); !word.empty(); word = words.next())
      static_cast<void>(finiteNumber(word));
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
    corner_.clear();
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) corner_.push_back(readCorner(word));
    if (corner_.size() < 3) fail(fmt::format("a face with {} corners", corner_.size()));
    for (std::size_t k = 2; k < corner_.size(); ++k) addTriangle(corner_[0], corner_[k - 1], corner_[k], number_);
  }

  std::vector<int> corner_;  ///< of the face being read
};

}  // namespace

TriangleMesh readObj(const SurfaceReader& start) { return ObjReader(start).read(); }

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
