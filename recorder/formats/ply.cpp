// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/ply.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/formats/ply_header.h"

namespace calot::recorder {
namespace {

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
            fmt::format("vertex {} is wanted, but the file has {} (from 0)", mesh_.triangle[t][k], mesh_.vertices()));
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
    const std::size_t size = plyBytes(type);
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
      fail(fmt::format("{} is no {}", value, what));
    }
    return static_cast<std::uint32_t>(value);
  }

  void pass(const PlyProperty& property) {
    const std::uint32_t count = property.list ? nextCount(property.countType, "length of a list") : 1;
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
    const int corners = plyCorners(*element_);
    for (std::size_t k = 0; k < element_->properties.size(); ++k) {
      const PlyProperty& property = element_->properties[k];
      if (static_cast<int>(k) != corners) {
        pass(property);
        continue;
      }
      const std::uint32_t count = nextCount(property.countType, "length of a list");
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
    const std::uint32_t index = nextCount(type, "index");
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
  PlyHeader header = takePlyHeader(text, name, limits);
  return PlyBody(text, std::move(header), name, metres(unit), limits).read();
}

}  // namespace calot::recorder
