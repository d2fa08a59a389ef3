// SPDX-License-Identifier: GPL-3.0-or-later

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numeric>
#include <string_view>
#include <vector>

#include "recorder/base/text_words.h"
#include "recorder/formats/surface_reader.h"

namespace calot::recorder {
namespace {

constexpr std::size_t headBytes = 84;
constexpr std::size_t triangleBytes = 50;

class StlReader : public SurfaceReader {
 public:
  explicit StlReader(const SurfaceReader& start) : SurfaceReader(start) {}

  TriangleMesh read() {
    const std::size_t bytes = text_.size();
    const std::uint32_t triangles = bytes < headBytes ? 0 : littleEndian(80);
    const std::uint64_t binaryBytes = headBytes + triangleBytes * std::uint64_t{triangles};
    if (bytes == binaryBytes) {
      readBinary(triangles);
    } else if (isText()) {
      passByteOrderMark();
      readText();
    } else if (triangles > 0 && bytes > binaryBytes) {
      readBinary(triangles);
      notes_.push_back(fmt::format("{} bytes after the last triangle were passed over", bytes - binaryBytes));
    } else if (bytes < headBytes) {
      failFile(fmt::format("{} bytes, which is neither an STL text nor a binary STL file", bytes));
    } else {
      failFile(
          fmt::format("{} triangles in a binary STL file take {} bytes, but it has {}", triangles, binaryBytes, bytes));
    }
    if (corner_.empty()) failFile("no triangle; a surface is expected");
    joinCorners();
    return std::move(mesh_);
  }

 private:
  /// Begins with "solid", and goes on as a text does: exporters write "solid" into binary files, too.
  [[nodiscard]] bool isText() const {
    std::string head = lowerCase(text_.substr(0, 1024));
    if (head.starts_with("\xEF\xBB\xBF")) head.erase(0, 3);
    const std::size_t begin = head.find_first_not_of(" \t\r\n");
    return begin != std::string::npos && head.compare(begin, 5, "solid") == 0 &&
           (text_.size() < headBytes || head.find("facet") != std::string::npos ||
            head.find('\0') == std::string::npos);
  }

  [[nodiscard]] std::uint32_t littleEndian(std::size_t at) const {
    std::uint32_t value = 0;
    for (unsigned k = 0; k < 4; ++k) value |= std::uint32_t{static_cast<unsigned char>(text_[at + k])} << (8 * k);
    return value;
  }

  /// One vertex for all corners at exactly one place, numbered in order of first mention.
  void joinCorners() {
    std::vector<std::size_t> order(corner_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto key = [this](std::size_t i) {
      return std::array<double, 3>{corner_[i][0], corner_[i][1], corner_[i][2]};
    };
    std::sort(order.begin(), order.end(), [&key](std::size_t a, std::size_t b) {
      const auto ka = key(a);
      const auto kb = key(b);
      return ka != kb ? ka < kb : a < b;
    });
    std::vector<std::size_t> first(corner_.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
      const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
      first[order[i]] = same ? first[order[i - 1]] : order[i];
    }
    std::vector<int> number(corner_.size());
    mesh_.triangle.resize(corner_.size() / 3);
    for (std::size_t i = 0; i < corner_.size(); ++i) {
      if (first[i] == i) {
        if (mesh_.vertex.size() >= limits_.vertices) failFile(fmt::format("more than {} vertices", limits_.vertices));
        number[i] = mesh_.vertices();
        mesh_.vertex.push_back(corner_[i]);
      } else {
        number[i] = number[first[i]];
      }
      mesh_.triangle[i / 3][static_cast<int>(i % 3)] = number[i];
    }
  }

  void readBinary(std::uint32_t triangles) {
    if (triangles > limits_.triangles) failFile(fmt::format("more than {} triangles", limits_.triangles));
    corner_.reserve(3 * std::size_t{triangles});
    part_ = "triangle";
    for (number_ = 0; number_ < triangles; ++number_) {
      std::size_t at = headBytes + triangleBytes * number_ + 12;  // after the normal
      for (int k = 0; k < 3; ++k) {
        Vec3 p;
        for (int a = 0; a < 3; ++a, at += 4) p[a] = place(static_cast<double>(std::bit_cast<float>(littleEndian(at))));
        checkPoint(p);
        corner_.push_back(p);
      }
    }
  }

  /// A coordinate of a corner; -0 is 0.
  [[nodiscard]] double place(double value) const { return coordinate(value) + 0.0; }

  void readText() {
    for (std::string word = nextWord(); !word.empty(); word = nextWord()) {
      if (word != "solid") fail(fmt::format("\"solid\" is expected, not \"{}\"", shown(word)));
      words_ = Words("");  // its name
      readSolid();
      words_ = Words("");
    }
  }

  /// In small letters; empty at the end of the file.
  std::string nextWord() {
    std::string_view word = words_.next();
    while (word.empty() && !text_.empty()) {
      words_ = Words(nextLine());
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
      p[k] = place(finiteNumber(word));
    }
    checkPoint(p);
    return p;
  }

  Words words_{""};
  std::vector<Vec3> corner_;  ///< three of each triangle
};

}  // namespace

TriangleMesh readStl(const SurfaceReader& start) { return StlReader(start).read(); }

}  // namespace calot::recorder
