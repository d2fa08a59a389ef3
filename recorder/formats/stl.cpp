// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_bytes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <string_view>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {
namespace {

constexpr std::size_t headBytes = 84;
constexpr std::size_t triangleBytes = 50;

std::uint32_t littleEndian(const std::byte* at) {
  std::uint32_t value = 0;
  for (unsigned k = 0; k < 4; ++k) value |= std::to_integer<std::uint32_t>(at[k]) << (8 * k);
  return value;
}

std::uint64_t binaryLength(std::span<const std::byte> bytes) {
  return headBytes + triangleBytes * std::uint64_t{littleEndian(bytes.data() + 80)};
}

bool beginsWithSolid(std::span<const std::byte> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), std::min<std::size_t>(bytes.size(), 256));
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  return lowerCase(text.substr(begin, 5)) == "solid";
}

/// Explains why the unit cannot be metres; empty if it can.
std::string coordinateFault(double value) {
  if (std::abs(value) <= farthestCoordinate) return {};
  return fmt::format("a coordinate of {} m: is the unit right?", value);
}

/// One vertex for all corners at exactly one place, numbered in order of first mention.
TriangleMesh joined(const std::vector<Vec3>& corner, const std::string& name, const SurfaceLimits& limits) {
  std::vector<std::size_t> order(corner.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto key = [&corner](std::size_t i) { return std::array<double, 3>{corner[i][0], corner[i][1], corner[i][2]}; };
  std::sort(order.begin(), order.end(), [&key](std::size_t a, std::size_t b) {
    const auto ka = key(a);
    const auto kb = key(b);
    return ka != kb ? ka < kb : a < b;
  });
  std::vector<std::size_t> first(corner.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  TriangleMesh mesh;
  std::vector<int> number(corner.size());
  mesh.triangle.resize(corner.size() / 3);
  for (std::size_t i = 0; i < corner.size(); ++i) {
    if (first[i] == i) {
      if (mesh.vertex.size() >= limits.vertices) {
        throw Error(ErrorKind::damaged, Where{name}, fmt::format("more than {} vertices", limits.vertices));
      }
      number[i] = mesh.vertices();
      mesh.vertex.push_back(corner[i]);
    } else {
      number[i] = number[first[i]];
    }
    mesh.triangle[i / 3][static_cast<int>(i % 3)] = number[i];
  }
  return mesh;
}

std::vector<Vec3> readBinary(std::span<const std::byte> bytes, const std::string& name, double scale,
                             const SurfaceLimits& limits) {
  const std::uint32_t triangles = littleEndian(bytes.data() + 80);
  if (triangles > limits.triangles) {
    throw Error(ErrorKind::damaged, Where{name}, fmt::format("more than {} triangles", limits.triangles));
  }
  std::vector<Vec3> corner;
  corner.reserve(3 * std::size_t{triangles});
  for (std::size_t t = 0; t < triangles; ++t) {
    const auto fail = [&name, t](const std::string& what) {
      throw Error(ErrorKind::damaged, Where{name, fmt::format("triangle {}", t)}, what);
    };
    const std::byte* at = bytes.data() + headBytes + triangleBytes * t + 12;  // after the normal
    for (int k = 0; k < 3; ++k) {
      Vec3 p;
      for (int a = 0; a < 3; ++a, at += 4) {
        const auto value = static_cast<double>(std::bit_cast<float>(littleEndian(at)));
        if (!std::isfinite(value)) fail("a coordinate that is not a finite number");
        p[a] = value * scale + 0.0;  // -0 is 0
        if (const std::string fault = coordinateFault(p[a]); !fault.empty()) fail(fault);
      }
      corner.push_back(p);
    }
  }
  return corner;
}

/// The words of a text file, with the line that they stand in.
class StlText {
 public:
  StlText(std::string_view text, const std::string& name, double scale, const SurfaceLimits& limits)
      : text_(text), words_(""), name_(name), scale_(scale), limits_(limits) {}

  std::vector<Vec3> read() {
    for (std::string word = nextWord(); !word.empty(); word = nextWord()) {
      if (word != "solid") fail(fmt::format("\"solid\" is expected, not \"{}\"", shown(word)));
      words_ = Words("");  // its name
      readSolid();
      words_ = Words("");
    }
    return std::move(corner_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorKind::damaged, Where{name_, fmt::format("line {}", line_)}, what);
  }

  /// In small letters; empty at the end of the file.
  std::string nextWord() {
    std::string_view word = words_.next();
    while (word.empty() && !text_.empty()) {
      const std::string_view line = takeLine(text_);
      ++line_;
      if (line.find('\0') != std::string_view::npos) fail("a zero byte; this is not a text file");
      words_ = Words(line);
      word = words_.next();
    }
    return lowerCase(word);
  }

  void expect(std::string_view wanted) {
    const std::string word = nextWord();
    if (word == wanted) return;
    if (word.empty()) fail(fmt::format("the file ends where \"{}\" is expected", wanted));
    fail(fmt::format("\"{}\" is expected, not \"{}\"", wanted, shown(word)));
  }

  void readSolid() {
    while (true) {
      const std::string word = nextWord();
      if (word == "endsolid") return;
      if (word.empty()) fail("the file ends before \"endsolid\"");
      if (word != "facet") fail(fmt::format("\"facet\" or \"endsolid\" is expected, not \"{}\"", shown(word)));
      if (corner_.size() / 3 >= limits_.triangles) fail(fmt::format("more than {} triangles", limits_.triangles));
      expect("normal");
      for (int k = 0; k < 3; ++k) {
        if (nextWord().empty()) fail("the file ends in a normal");
      }
      expect("outer");
      expect("loop");
      for (int k = 0; k < 3; ++k) {
        expect("vertex");
        corner_.push_back(readPoint());
      }
      expect("endloop");
      expect("endfacet");
    }
  }

  Vec3 readPoint() {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      const std::string word = nextWord();
      if (word.empty()) fail("the file ends in a vertex");
      std::string fault;
      p[k] = readFiniteNumber(word, fault) * scale_ + 0.0;
      if (fault.empty()) fault = coordinateFault(p[k]);
      if (!fault.empty()) fail(fault);
    }
    return p;
  }

  std::string_view text_;
  Words words_;
  const std::string& name_;
  double scale_;
  SurfaceLimits limits_;
  std::vector<Vec3> corner_;
  std::size_t line_ = 0;
};

}  // namespace

TriangleMesh parseStl(std::span<const std::byte> bytes, const std::string& name, LengthUnit unit,
                      const SurfaceLimits& limits) {
  if (bytes.size() > limits.bytes) {
    throw Error(ErrorKind::damaged, Where{name}, fmt::format("larger than {} bytes", limits.bytes));
  }
  std::vector<Vec3> corner;
  if (bytes.size() >= headBytes && binaryLength(bytes) == bytes.size()) {
    corner = readBinary(bytes, name, metres(unit), limits);
  } else if (beginsWithSolid(bytes)) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    corner = StlText(text, name, metres(unit), limits).read();
  } else if (bytes.size() < headBytes) {
    throw Error(ErrorKind::damaged, Where{name},
                fmt::format("{} bytes, which is neither an STL text nor a binary STL file", bytes.size()));
  } else {
    throw Error(ErrorKind::damaged, Where{name},
                fmt::format("{} triangles in a binary STL file take {} bytes, but it has {}",
                            littleEndian(bytes.data() + 80), binaryLength(bytes), bytes.size()));
  }
  if (corner.empty()) throw Error(ErrorKind::damaged, Where{name}, "no triangle; a surface is expected");
  return joined(corner, name, limits);
}

}  // namespace calot::recorder
