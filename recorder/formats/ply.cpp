// SPDX-License-Identifier: GPL-3.0-or-later

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <string_view>
#include <utility>
#include <vector>

#include "recorder/base/text_words.h"
#include "recorder/formats/surface_reader.h"

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

constexpr std::size_t maxElements = 32;
constexpr std::size_t maxProperties = 128;

class PlyReader : public SurfaceReader {
 public:
  explicit PlyReader(const SurfaceReader& start) : SurfaceReader(start) {}

  TriangleMesh read() {
    passByteOrderMark();
    readHeader();
    for (const PlyElement& element : elements_) {
      element_ = &element;
      if (format_ != PlyFormat::ascii) part_ = element.name;
      for (row_ = 0; row_ < element.count; ++row_) {
        if (format_ != PlyFormat::ascii) number_ = row_;
        if (element.name == "vertex") {
          readVertex();
        } else if (element.name == "face") {
          readFace();
        } else {
          for (const PlyProperty& property : element.properties) pass(property);
        }
      }
    }
    return finish("face", 0, " (from 0)");
  }

 private:
  /// Reads up to and including the line "end_header". The element `vertex` has x, y and z and `face` a list of indices,
  /// both within the limits.
  void readHeader() {
    if (Words first(headerLine()); first.next() != "ply" || !first.next().empty()) {
      fail("a PLY file begins with \"ply\"");
    }
    while (true) {
      if (text_.empty()) fail("the file ends before \"end_header\"");
      Words words(headerLine());
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
    checkHeader();
  }

  std::string_view headerLine() { return nextLine("a zero byte in the header"); }

  void readFormat(Words& words) {
    const std::string_view format = words.next();
    const std::string_view version = words.next();
    if (hasFormat_) fail("a second \"format\"");
    hasFormat_ = true;
    const auto* const known = std::find(std::begin(plyFormats), std::end(plyFormats), format);
    if (known == std::end(plyFormats))
      fail(fmt::format("format \"{}\"; known are {}", shown(format), fmt::join(plyFormats, ", ")));
    format_ = static_cast<PlyFormat>(known - std::begin(plyFormats));
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
    if (std::any_of(elements_.begin(), elements_.end(), [&](const PlyElement& e) { return e.name == element.name; })) {
      fail(fmt::format("a second element \"{}\"", element.name));
    }
    if (elements_.size() >= maxElements) fail(fmt::format("more than {} elements", maxElements));
    elements_.push_back(std::move(element));
  }

  PlyType readType(std::string_view word) const {
    for (std::size_t i = 0; i < std::size(plyTypes); ++i) {
      if (word == plyTypes[i].name || word == plyTypes[i].oldName) return static_cast<PlyType>(i);
    }
    fail(fmt::format("\"{}\" is not a type of PLY", shown(word)));
  }

  void readProperty(Words& words) {
    if (elements_.empty()) fail("a property before any element");
    PlyElement& element = elements_.back();
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

  void checkHeader() const {
    if (!hasFormat_) fail("the header does not say its format");
    bool hasVertices = false;
    bool hasFaces = false;
    for (const PlyElement& element : elements_) {
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

  std::string_view nextWord() {
    std::string_view word = words_.next();
    while (word.empty()) {
      if (text_.empty()) fail(fmt::format("the file ends at {} {} of {}", element_->name, row_, element_->count));
      words_ = Words(takeLine(text_));
      ++number_;
      word = words_.next();
    }
    return word;
  }

  /// The next value; a whole number of at most 32 bits is exact in a double.
  double next(PlyType type) {
    if (format_ == PlyFormat::ascii) return finiteNumber(nextWord());
    const std::size_t size = plyTypes[static_cast<std::size_t>(type)].bytes;
    if (text_.size() < size) fail(fmt::format("the file ends here, with {} wanted", element_->count));
    std::uint64_t bits = 0;
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t at = format_ == PlyFormat::littleEndian ? size - 1 - k : k;
      bits = (bits << 8U) | static_cast<unsigned char>(text_[at]);
    }
    text_.remove_prefix(size);
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
      format_ == PlyFormat::ascii ? static_cast<void>(nextWord()) : static_cast<void>(next(property.type));
    }
  }

  void readVertex() {
    Vec3 p = Vec3::Zero();
    for (const PlyProperty& property : element_->properties) {
      if (property.name.size() != 1 || property.name[0] < 'x' || property.name[0] > 'z') {
        pass(property);
        continue;
      }
      p[property.name[0] - 'x'] = coordinate(next(property.type));
    }
    addVertex(p);
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
        const int last = nextIndex(property.type);
        addTriangle(first, before, last, row_);
        before = last;
      }
    }
  }

  int nextIndex(PlyType type) {
    const std::uint32_t index = nextCount(type, "an index");
    if (index >= limits_.vertices) fail(fmt::format("vertex {}, but a file has at most {}", index, limits_.vertices));
    return static_cast<int>(index);
  }

  Words words_{""};  ///< of an ASCII file's line
  PlyFormat format_ = PlyFormat::ascii;
  bool hasFormat_ = false;
  std::vector<PlyElement> elements_;  ///< names differ, as do those of each one's properties
  const PlyElement* element_ = nullptr;
  std::uint64_t row_ = 0;  ///< of the element, from 0
};

}  // namespace

TriangleMesh readPly(const SurfaceReader& start) { return PlyReader(start).read(); }

}  // namespace calot::recorder
