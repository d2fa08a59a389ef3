// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_bytes.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {
namespace {

enum class PlyFormat : std::uint8_t { ascii, littleEndian, bigEndian };
constexpr std::string_view plyFormats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Bytes and names of the types, in their order.
struct PlyTypeInfo {
  std::size_t bytes;
  std::string_view name, oldName;
};
constexpr PlyTypeInfo plyTypes[] = {{1, "int8", "char"},     {1, "uint8", "uchar"},   {2, "int16", "short"},
                                    {2, "uint16", "ushort"}, {4, "int32", "int"},     {4, "uint32", "uint"},
                                    {4, "float32", "float"}, {8, "float64", "double"}};

bool isWhole(PlyType type) { return type != PlyType::float32 && type != PlyType::float64; }

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;
  bool list = false;
  PlyType countType = PlyType::uint8;  ///< of a list: whole numbers
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;  ///< at least one

  /// Place of a property, or -1.
  [[nodiscard]] int find(std::string_view property) const {
    const auto found =
        std::find_if(properties.begin(), properties.end(), [&](const PlyProperty& p) { return p.name == property; });
    return found == properties.end() ? -1 : static_cast<int>(found - properties.begin());
  }
  /// Place of the property that holds a face's corners, or -1.
  [[nodiscard]] int corners() const {
    const int plural = find("vertex_indices");
    return plural >= 0 ? plural : find("vertex_index");
  }
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<PlyElement> elements;  ///< names differ, as do those of each one's properties
  std::size_t lines = 0;             ///< of the header
};

constexpr std::size_t maxElements = 32;
constexpr std::size_t maxProperties = 128;

/// Parses and removes the header of a file's text, up to and including the line "end_header". The element `vertex` has
/// x, y and z and `face` a list of indices, both within the limits.
class HeaderReader {
 public:
  HeaderReader(std::string_view& text, const std::string& name, const SurfaceLimits& limits)
      : text_(text), name_(name), limits_(limits) {}

  PlyHeader read() {
    if (Words first(nextLine()); first.next() != "ply" || !first.next().empty()) {
      fail("a PLY file begins with \"ply\"");
    }
    while (true) {
      if (text_.empty()) fail("the file ends before \"end_header\"");
      Words words(nextLine());
      const std::string_view keyword = words.next();
      if (keyword == "end_header") break;
      if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) continue;
      if (keyword == "format") {
        readFormat(words);
      } else if (keyword == "element") {
        readElement(words);
      } else if (keyword == "property") {
        readProperty(words);
      } else {
        fail(fmt::format("\"{}\" is not a keyword of a PLY header", shown(keyword)));
      }
    }
    check();
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::damaged, Where{name_, fmt::format("line {}", header_.lines)}, what);
  }

  std::string_view nextLine() {
    ++header_.lines;
    const std::string_view line = takeLine(text_);
    if (line.find('\0') != std::string_view::npos) fail("a zero byte in the header");
    return line;
  }

  void readFormat(Words& words) {
    const std::string_view format = words.next();
    const std::string_view version = words.next();
    if (hasFormat_) fail("a second \"format\"");
    hasFormat_ = true;
    const auto* const known = std::find(std::begin(plyFormats), std::end(plyFormats), format);
    if (known == std::end(plyFormats))
      fail(fmt::format("format \"{}\"; known are {}", shown(format), fmt::join(plyFormats, ", ")));
    header_.format = static_cast<PlyFormat>(known - std::begin(plyFormats));
    if (version != "1.0") fail(fmt::format("version \"{}\" of PLY; 1.0 is known", shown(version)));
  }

  void readElement(Words& words) {
    PlyElement element;
    element.name = shown(words.next());
    std::string fault;
    const long long count = readWholeNumber(words.next(), fault);
    if (!fault.empty()) fail(fault);
    if (count < 0) fail(fmt::format("{} of an element", count));
    element.count = static_cast<std::uint64_t>(count);
    if (element.name == "vertex" && element.count > limits_.vertices) {
      fail(fmt::format("more than {} vertices", limits_.vertices));
    }
    if (element.name == "face" && element.count > limits_.triangles) {
      fail(fmt::format("more than {} triangles", limits_.triangles));
    }
    const auto& all = header_.elements;
    if (std::any_of(all.begin(), all.end(), [&](const PlyElement& e) { return e.name == element.name; })) {
      fail(fmt::format("a second element \"{}\"", element.name));
    }
    if (all.size() >= maxElements) fail(fmt::format("more than {} elements", maxElements));
    header_.elements.push_back(std::move(element));
  }

  PlyType readType(std::string_view word) const {
    for (std::size_t i = 0; i < std::size(plyTypes); ++i) {
      if (word == plyTypes[i].name || word == plyTypes[i].oldName) return static_cast<PlyType>(i);
    }
    fail(fmt::format("\"{}\" is not a type of PLY", shown(word)));
  }

  void readProperty(Words& words) {
    if (header_.elements.empty()) fail("a property before any element");
    PlyElement& element = header_.elements.back();
    PlyProperty property;
    std::string_view word = words.next();
    if (word == "list") {
      property.list = true;
      property.countType = readType(words.next());
      if (!isWhole(property.countType)) fail("a list is counted in whole numbers");
      word = words.next();
    }
    property.type = readType(word);
    property.name = shown(words.next());
    if (property.name.empty()) fail("a property without a name");
    if (element.find(property.name) >= 0) fail(fmt::format("a second property \"{}\"", property.name));
    if (element.properties.size() >= maxProperties) fail(fmt::format("more than {} properties", maxProperties));
    element.properties.push_back(std::move(property));
  }

  void check() const {
    if (!hasFormat_) fail("the header does not say its format");
    bool hasVertices = false;
    bool hasFaces = false;
    for (const PlyElement& element : header_.elements) {
      if (element.properties.empty()) fail(fmt::format("element \"{}\" has no property", element.name));
      if (element.name == "vertex") {
        hasVertices = element.count > 0;
        for (const char* axis : {"x", "y", "z"}) {
          const int at = element.find(axis);
          if (at < 0) fail(fmt::format("vertices have no property \"{}\"", axis));
          if (element.properties[static_cast<std::size_t>(at)].list) fail(fmt::format("\"{}\" is a list", axis));
        }
      } else if (element.name == "face") {
        hasFaces = element.count > 0;
        const int at = element.corners();
        if (at < 0) fail("faces have no property \"vertex_indices\"");
        const PlyProperty& corners = element.properties[static_cast<std::size_t>(at)];
        if (!corners.list) fail("\"vertex_indices\" is not a list");
        if (!isWhole(corners.type)) fail("indices are whole numbers");
      }
    }
    if (!hasVertices) fail("no vertex");
    if (!hasFaces) fail("no face; a surface is expected");
  }

  std::string_view& text_;
  const std::string& name_;
  const SurfaceLimits& limits_;
  PlyHeader header_;
  bool hasFormat_ = false;
};

class PlyBody {
 public:
  PlyBody(std::string_view body, PlyHeader header, const std::string& name, double scale, const SurfaceLimits& limits)
      : body_(body), words_(""), header_(std::move(header)), name_(name), scale_(scale), limits_(limits) {
    line_ = header_.lines;
  }

  TriangleMesh read() {
    for (const PlyElement& element : header_.elements) {
      element_ = &element;
      const bool vertices = element.name == "vertex";
      const bool faces = element.name == "face";
      for (number_ = 0; number_ < element.count; ++number_) {
        if (vertices) {
          readVertex();
        } else if (faces) {
          readFace();
        } else {
          for (const PlyProperty& property : element.properties) pass(property);
        }
      }
    }
    // Faces may come before the vertices.
    for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (mesh_.triangle[t][k] < mesh_.vertices()) continue;
        throw Error(
            ErrorKind::damaged, Where{name_, fmt::format("face {}", face_[t])},
            fmt::format("vertex {} is expected, but the file has {} (from 0)", mesh_.triangle[t][k], mesh_.vertices()));
      }
    }
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    const std::string place = header_.format == PlyFormat::ascii ? fmt::format("line {}", line_)
                                                                 : fmt::format("{} {}", element_->name, number_);
    throw Error(ErrorKind::damaged, Where{name_, place}, what);
  }

  std::string_view nextWord() {
    std::string_view word = words_.next();
    while (word.empty()) {
      if (body_.empty()) fail(fmt::format("the file ends at {} {} of {}", element_->name, number_, element_->count));
      words_ = Words(takeLine(body_));
      ++line_;
      word = words_.next();
    }
    return word;
  }

  /// The next value; a whole number of at most 32 bits is exact in a double.
  double next(PlyType type) {
    if (header_.format == PlyFormat::ascii) {
      std::string fault;
      const double value = readFiniteNumber(nextWord(), fault);
      if (!fault.empty()) fail(fault);
      return value;
    }
    const std::size_t size = plyTypes[static_cast<std::size_t>(type)].bytes;
    if (body_.size() < size) fail(fmt::format("the file ends here, with {} wanted", element_->count));
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t at = header_.format == PlyFormat::littleEndian ? size - 1 - k : k;
      bits = (bits << 8U) | static_cast<unsigned char>(body_[at]);
    }
    body_.remove_prefix(size);
    switch (type) {
      case PlyType::int8:
        return static_cast<double>(static_cast<std::int8_t>(bits));
      case PlyType::int16:
        return static_cast<double>(static_cast<std::int16_t>(bits));
      case PlyType::int32:
        return static_cast<double>(static_cast<std::int32_t>(bits));
      case PlyType::float32:
        return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
      case PlyType::float64:
        return std::bit_cast<double>(bits);
      case PlyType::uint8:
      case PlyType::uint16:
      case PlyType::uint32:
        break;
    }
    return static_cast<double>(bits);
  }

  /// A whole number that is not negative.
  std::uint32_t nextCount(PlyType type, const char* what) {
    const double value = next(type);
    if (!(value >= 0.0 && value <= 4294967295.0) || value != std::floor(value)) {
      fail(fmt::format("{} is not {}", value, what));
    }
    return static_cast<std::uint32_t>(value);
  }

  void pass(const PlyProperty& property) {
    const std::uint32_t count = property.list ? nextCount(property.countType, "a length of a list") : 1;
    for (std::uint32_t i = 0; i < count; ++i) {
      // Unused values may be anything, including NaN.
      header_.format == PlyFormat::ascii ? static_cast<void>(nextWord()) : static_cast<void>(next(property.type));
    }
  }

  void readVertex() {
    Vec3 p = Vec3::Zero();
    for (const PlyProperty& property : element_->properties) {
      const bool coordinate = property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z';
      if (!coordinate) {
        pass(property);
        continue;
      }
      const double value = next(property.type);
      if (!std::isfinite(value)) fail("a coordinate that is not a finite number");
      const double length = value * scale_;
      if (!(std::abs(length) <= farthestCoordinate)) {
        fail(fmt::format("a coordinate of {} m: is the unit right?", length));
      }
      p[property.name[0] - 'x'] = length;
    }
    mesh_.vertex.push_back(p);
  }

  void readFace() {
    const int corners = element_->corners();
    for (std::size_t k = 0; k < element_->properties.size(); ++k) {
      const PlyProperty& property = element_->properties[k];
      if (static_cast<int>(k) != corners) {
        pass(property);
        continue;
      }
      const std::uint32_t count = nextCount(property.countType, "a length of a list");
      if (count < 3) fail(fmt::format("a face with {} corners", count));
      const int first = nextIndex(property.type);
      int before = nextIndex(property.type);
      for (std::uint32_t i = 2; i < count; ++i) {
        if (mesh_.triangle.size() >= limits_.triangles) fail(fmt::format("more than {} triangles", limits_.triangles));
        const int last = nextIndex(property.type);
        mesh_.triangle.emplace_back(first, before, last);
        face_.push_back(number_);
        before = last;
      }
    }
  }

  int nextIndex(PlyType type) {
    const std::uint32_t index = nextCount(type, "an index");
    if (index >= limits_.vertices) fail(fmt::format("vertex {}, but a file has at most {}", index, limits_.vertices));
    return static_cast<int>(index);
  }

  std::string_view body_;
  Words words_;
  PlyHeader header_;
  const std::string& name_;
  double scale_;
  SurfaceLimits limits_;
  TriangleMesh mesh_;
  std::vector<std::uint64_t> face_;  ///< of each triangle
  const PlyElement* element_ = nullptr;
  std::uint64_t number_ = 0;  ///< of the element, from 0
  std::size_t line_ = 0;
};

}  // namespace

TriangleMesh parsePly(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const SurfaceLimits& limits) {
  if (bytes.size() > limits.bytes) {
    throw Error(ErrorKind::damaged, Where{name}, fmt::format("larger than {} bytes", limits.bytes));
  }
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  PlyHeader header = HeaderReader(text, name, limits).read();
  return PlyBody(text, std::move(header), name, metres(unit), limits).read();
}

}  // namespace calot::recorder
