// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_bytes.h"

#include <fmt/format.h>
#include <algorithm>
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

constexpr std::size_t frameBytes = 4096;  ///< where a file may say its frame

/// Reader for the format that the name's end states, or null.
Reader readerOf(const std::string& name) {
  constexpr std::pair<std::string_view, Reader> readers[] = {
      {".obj", readObj}, {".stl", readStl}, {".ply", readPly}, {".off", readOff}};
  const std::string end = lowerCase(std::string_view(name).substr(name.size() < 4 ? 0 : name.size() - 4));
  for (const auto& [ending, reader] : readers) {
    if (end == ending) return reader;
  }
  return nullptr;
}

}  // namespace

std::string surfaceNameFault(const std::string& name) {
  if (readerOf(name) != nullptr) return {};
  constexpr std::pair<std::string_view, std::string_view> others[] = {
      {".vtp .vtk .vtu", "; 3D Slicer and ParaView save a surface as .stl or .ply"},
      {".glb .gltf .fbx .dae .blend .usdz .wrl .x3d", "; Blender exports such a model as .stl or .obj"},
      {".3mf .amf .step .stp .iges .igs", "; the program that wrote it exports a surface as .stl"},
      {".nii .nii.gz .nrrd .mha .dcm", "; this is a volume: 3D Slicer exports a segmentation's surface as .stl"}};
  std::string fault = "surfaces are read from .obj, .stl, .ply and .off files";
  for (const auto& [endings, advice] : others) {
    Words words(endings);
    for (std::string_view ending = words.next(); !ending.empty(); ending = words.next())
      if (lowerCase(name).ends_with(ending)) fault += advice;
  }
  return fault;
}

TriangleMesh parseSurface(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                          const SurfaceLimits& limits, std::vector<std::string>* notes) {
  std::vector<std::string> done;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const SurfaceReader start(text, name, unit, limits, done);
  const Reader read = readerOf(name);
  if (read == nullptr) start.failFile(surfaceNameFault(name));
  if (bytes.size() > limits.bytes) start.failFile(fmt::format("larger than {} bytes", limits.bytes));
  TriangleMesh mesh = read(start);
  if (text.substr(0, frameBytes).find("SPACE=LPS") != std::string_view::npos) {
    for (Vec3& p : mesh.vertex) p = Vec3(-p[0], -p[1], p[2]);
    done.emplace_back("the file says that it is in LPS: x and y were turned to RAS");
  }
  if (notes != nullptr) notes->insert(notes->end(), done.begin(), done.end());
  return mesh;
}

namespace {

constexpr std::string_view passedOver[] = {"vt", "vn",  "vp",    "s",        "l",       "p",
                                           "mg", "lod", "bevel", "c_interp", "d_interp"};
/// Keywords before a name, in which \ is a character like others.
constexpr std::string_view naming[] = {"g", "o", "usemtl", "mtllib", "usemap", "maplib"};

bool isAmong(std::string_view word, std::span<const std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

class ObjReader : public SurfaceReader {
 public:
  explicit ObjReader(const SurfaceReader& start) : SurfaceReader(start) {}

  TriangleMesh read() {
    passByteOrderMark();
    while (!text_.empty()) readLine(nextLine());
    if (mesh_.vertex.empty()) failFile("no vertex; not an OBJ file, or an empty one");
    TriangleMesh mesh = finish("line", 1, "");
    if (mesh.triangle.empty()) failFile("vertices but no face; a surface is expected");
    return mesh;
  }

 private:
  void readLine(std::string_view line) {
    Words words(line, '#');
    std::string_view keyword = words.next();
    if (keyword.empty() || isAmong(keyword, naming)) return;
    const std::size_t first = number_;
    if (isContinued(line)) {
      joined_.clear();
      for (; isContinued(line); line = nextLine()) joined_.append(line.substr(0, line.rfind('\\'))).push_back(' ');
      words = Words(joined_.append(line), '#');
      keyword = words.next();
    }
    if (keyword == "v") {
      readVertex(words);
    } else if (keyword == "f") {
      readFace(words, first);
    } else if (!isAmong(keyword, passedOver)) {
      fail(fmt::format("\"{}\" is not a keyword of a polygonal OBJ file", shown(keyword)));
    }
  }

  /// Does it end with \, the last line of the file apart?
  [[nodiscard]] bool isContinued(std::string_view line) const {
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line.ends_with('\\') && line.find('#') == std::string_view::npos && !text_.empty();
  }

  void readVertex(Words& words) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = words.next();
      if (word.empty()) fail(fmt::format("a vertex with {} of 3 coordinates", k));
      p[k] = coordinate(finiteNumber(word));
    }
    addVertex(p);
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

  /// Exporters leave out texture and normal before and after each "/".
  int readCorner(std::string_view word) const {
    const std::size_t slash = std::min(word.find('/'), word.size());
    const int vertex = readIndex(word.substr(0, slash), true);
    std::string_view rest = word.substr(slash);
    for (int part = 0; part < 2 && !rest.empty(); ++part) {
      rest.remove_prefix(1);
      const std::string_view index = part == 0 ? rest.substr(0, rest.find('/')) : rest;
      if (!index.empty()) static_cast<void>(readIndex(index, false));
      rest.remove_prefix(index.size());
    }
    return vertex;
  }

  void readFace(Words& words, std::size_t line) {
    corner_.clear();
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) corner_.push_back(readCorner(word));
    if (corner_.size() < 3) fail(fmt::format("a face with {} corners", corner_.size()));
    for (std::size_t k = 2; k < corner_.size(); ++k) addTriangle(corner_[0], corner_[k - 1], corner_[k], line);
  }

  std::string joined_;       ///< lines that continue each other
  std::vector<int> corner_;  ///< of the face being read
};

class OffReader : public SurfaceReader {
 public:
  explicit OffReader(const SurfaceReader& start) : SurfaceReader(start) {}

  TriangleMesh read() {
    passByteOrderMark();
    Words words = nextWords();
    if (const std::string_view kind = words.next(); !kind.ends_with("OFF") || kind.find_first_of("4n") < kind.size())
      fail("\"OFF\" is expected");
    std::string_view word = words.next();
    if (word == "BINARY") fail("a binary OFF file is not read; export it as text, or as .ply");
    if (word.empty()) word = (words = nextWords()).next();
    const std::size_t vertices = count(word, limits_.vertices);
    const std::size_t faces = count(words.next(), limits_.triangles);
    for (std::size_t i = 0; i < vertices; ++i) {
      words = nextWords();
      Vec3 p;
      for (int k = 0; k < 3; ++k) p[k] = coordinate(finiteNumber(words.next()));
      addVertex(p);
    }
    for (std::size_t i = 0; i < faces; ++i) {
      words = nextWords();
      const std::size_t corners = count(words.next(), limits_.vertices);
      if (corners < 3) fail(fmt::format("a face with {} corners", corners));
      const auto index = [&] { return static_cast<int>(count(words.next(), limits_.vertices)); };
      const int first = index();
      int before = index();
      for (std::size_t k = 2; k < corners; ++k) {
        const int last = index();
        addTriangle(first, before, last, number_);
        before = last;
      }
    }
    if (mesh_.triangle.empty()) failFile("no face; a surface is expected");
    return finish("line", 0, " (from 0)");
  }

 private:
  /// Words of the next line that has some.
  Words nextWords() {
    while (!text_.empty()) {
      const std::string_view line = nextLine();
      if (!Words(line, '#').next().empty()) return Words(line, '#');
    }
    fail("the file ends here");
  }

  [[nodiscard]] std::size_t count(std::string_view word, std::size_t most) const {
    std::string fault;
    const long long value = readWholeNumber(word, fault);
    if (!fault.empty()) fail(fault);
    if (value < 0 || static_cast<std::size_t>(value) > most) fail(fmt::format("{}: 0 to {} is expected", value, most));
    return static_cast<std::size_t>(value);
  }
};

}  // namespace

TriangleMesh readObj(const SurfaceReader& start) { return ObjReader(start).read(); }
TriangleMesh readOff(const SurfaceReader& start) { return OffReader(start).read(); }

int dropUnusedVertices(TriangleMesh& mesh) {
  std::vector<int> number(mesh.vertex.size(), -1);
  for (const Index3& t : mesh.triangle) {
    for (const int v : t) number[slot(v)] = 0;
  }
  int used = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    mesh.vertex[slot(used)] = mesh.vertex[v];
    number[v] = used++;
  }
  mesh.vertex.resize(slot(used));
  for (Index3& t : mesh.triangle) {
    for (int& v : t) v = number[slot(v)];
  }
  return static_cast<int>(number.size()) - used;
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
