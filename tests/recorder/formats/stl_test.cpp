// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_bytes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "sim/geometry/surface_report.h"
#include "sim/math/random.h"
#include "tests/support/fault.h"

namespace calot::recorder::stl_test {
namespace {

TriangleMesh parse(const std::string& bytes, LengthUnit unit = LengthUnit::metre, const SurfaceLimits& limits = {}) {
  return parseSurface(std::as_bytes(std::span(bytes.data(), bytes.size())), "t.stl", unit, limits);
}

std::optional<Error> refusal(const std::string& bytes, const SurfaceLimits& limits = {}) {
  return caught([&] { parse(bytes, LengthUnit::metre, limits); });
}

using Corners = std::vector<std::array<float, 9>>;

const Corners tetrahedron{
    {0, 0, 0, 0, 1, 0, 1, 0, 0}, {0, 0, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 1, 0, 1, 0}, {1, 0, 0, 0, 1, 0, 0, 0, 1}};

std::string ascii(const Corners& triangles) {
  std::string text = "solid a name\n";
  for (const auto& t : triangles) {
    text += "  facet normal 0 0 nan\n    outer loop\n";
    for (std::size_t k = 0; k < 9; k += 3) {
      text += "      vertex " + std::to_string(t[k]) + " " + std::to_string(t[k + 1]) + " " + std::to_string(t[k + 2]) +
              "\n";
    }
    text += "    endloop\n  endfacet\n";
  }
  return text + "endsolid a name\n";
}

void append(std::string& bytes, const void* from, std::size_t size) {
  bytes.append(static_cast<const char*>(from), size);  // the machine that runs the tests is little endian
}

std::string binary(const Corners& triangles, std::uint32_t count, const std::string& head = "made by a test") {
  std::string bytes = head;
  bytes.resize(80, ' ');
  append(bytes, &count, 4);
  const std::array<float, 3> normal{std::numeric_limits<float>::quiet_NaN(), 0, 0};
  for (const auto& t : triangles) {
    append(bytes, normal.data(), 12);
    append(bytes, t.data(), 36);
    bytes += "\x12\x34";
  }
  return bytes;
}

std::string binary(const Corners& triangles) { return binary(triangles, static_cast<std::uint32_t>(triangles.size())); }

TEST(Stl, TextAndBinaryGiveTheSameClosedSurface) {
  for (const std::string& bytes : {ascii(tetrahedron), binary(tetrahedron), binary(tetrahedron, 4, "solid or so")}) {
    const TriangleMesh mesh = parse(bytes, LengthUnit::centimetre);
    ASSERT_EQ(mesh.vertices(), 4);
    ASSERT_EQ(mesh.triangles(), 4);
    EXPECT_EQ(mesh.vertex[1], Vec3(0, 0.01, 0));
    EXPECT_EQ(mesh.triangle[3], Index3(2, 1, 3));
    const SurfaceReport report = inspectSurface(mesh);
    EXPECT_TRUE(report.closedManifold());
    EXPECT_NEAR(report.volume, 1e-6 / 6.0, 1e-18);
  }
}

TEST(Stl, ZerosOfBothSignsAreOnePlaceAndNeighboursAreNot) {
  const float next = std::nextafter(1.0F, 2.0F);
  const TriangleMesh mesh = parse(binary({{0, 0, 0, 1, 0, 0, 0, 1, 0}, {-0.0F, 0, -0.0F, 0, 1, 0, next, 0, 0}}));
  EXPECT_EQ(mesh.vertices(), 4);
  EXPECT_EQ(mesh.triangle[1], Index3(0, 2, 3));
}

TEST(Stl, BytesAfterTheLastTriangleAreNoted) {
  for (const char* head : {"solid or so", "made by a test"}) {
    const std::string bytes = binary(tetrahedron, 4, std::string(head) + '\0') + "xyz";
    std::vector<std::string> notes;
    const TriangleMesh mesh =
        parseSurface(std::as_bytes(std::span(bytes.data(), bytes.size())), "t.stl", LengthUnit::metre, {}, &notes);
    EXPECT_TRUE(inspectSurface(mesh).closedManifold());
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].substr(0, 2), "3 ");
  }
}

TEST(Stl, WordsMayBeCapitalAndSeveralSolidsAreOne) {
  std::string text = ascii(tetrahedron);
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  EXPECT_EQ(parse(text).triangles(), 4);
  EXPECT_EQ(parse("\r\n " + text + "solid\nendsolid\n" + text).triangles(), 8);
}

TEST(Stl, RefusesWithThePlace) {
  const std::string open = "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  const BadInput bad[] = {
      {"solid x\n", "t.stl: line 1", {"\"endsolid\""}},
      {"solid x\nfacet normal 0 0", "t.stl: line 2", {}},
      {open, "t.stl: line 5", {"\"vertex\""}},
      {open + "vertex 1 1", "t.stl: line 6", {}},
      {open + "vertex 1 1 nan\n", "t.stl: line 6", {"\"nan\""}},
      {open + "vertex 1 1 1e999\n", "t.stl: line 6", {"\"1e999\""}},
      {open + "vertex 1 1 1,5\n", "t.stl: line 6", {"\"1,5\""}},
      {open + "vertex 1 1 5000\n", "t.stl: line 6", {"5000"}},
      {open + "endloop\n", "t.stl: line 6", {"\"vertex\"", "\"endloop\""}},
      {open + "vertex 1 1 0\nvertex 0 1 0\nendloop", "t.stl: line 7", {"\"endloop\"", "\"vertex\""}},
      {open + std::string("vertex 1 \0 0\n", 13), "t.stl: line 6", {}},
      {"solid x\nface normal 0 0 1\n", "t.stl: line 2", {"\"facet\"", "\"endsolid\"", "\"face\""}},
      {"solid x\nendsolid x\nv 0 0 0\n", "t.stl: line 3", {"\"solid\"", "\"v\""}},
      {"solid x\nendsolid x\n", "t.stl", {}},
      {"", "t.stl", {"0"}},
      {binary({}), "t.stl", {}},
      {binary(tetrahedron, 5), "t.stl", {"5", "334", "284"}},
      {binary(tetrahedron, 0xffffffffU), "t.stl", {"4294967295", "214748364834", "284"}},
      {binary(tetrahedron).substr(0, 200), "t.stl", {"4", "284", "200"}},
      {binary({{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 0, 0, 1, 0, 0, 0, std::numeric_limits<float>::infinity(), 0}}),
       "t.stl: triangle 1",
       {}},
      {binary({{0, 0, 0, 1, 0, 0, 0, 2000, 0}}), "t.stl: triangle 0", {"2000"}},
  };
  for (const auto& [bytes, where, values] : bad) expectFault(ErrorKind::damaged, where, values, refusal(bytes));
}

TEST(Stl, RefusesTooMuch) {
  SurfaceLimits limits;
  limits.triangles = 3;
  expectFault(ErrorKind::damaged, "t.stl: line 23", {"3"}, refusal(ascii(tetrahedron), limits));
  expectFault(ErrorKind::damaged, "t.stl", {"3"}, refusal(binary(tetrahedron), limits));
  limits = {};
  limits.vertices = 3;
  expectFault(ErrorKind::damaged, "t.stl", {"3"}, refusal(binary(tetrahedron), limits));
  limits = {};
  limits.bytes = 100;
  expectFault(ErrorKind::damaged, "t.stl", {"100"}, refusal(binary(tetrahedron), limits));
}

TEST(Stl, DamagedBytesAreReadOrRefusedButNeverMore) {
  const std::uint64_t seed = 90210;
  SCOPED_TRACE(seed);
  Random random(seed);
  int refused = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const std::string ok = trial % 2 == 0 ? ascii(tetrahedron) : binary(tetrahedron);
    std::string bytes = ok.substr(0, trial % 3 == 0 ? random.next() % ok.size() : ok.size());
    for (auto flips = random.next() % 4; flips > 0 && !bytes.empty(); --flips) {
      char& c = bytes[random.next() % bytes.size()];
      c = static_cast<char>(static_cast<unsigned char>(c) ^ (1U << (random.next() % 8)));
    }
    try {
      const TriangleMesh mesh = parse(bytes);
      for (const Index3& v : mesh.triangle) ASSERT_TRUE(v.minCoeff() >= 0 && v.maxCoeff() < mesh.vertices());
      for (const Vec3& p : mesh.vertex) ASSERT_TRUE(p.allFinite());
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::damaged);
      ++refused;
    }
  }
  EXPECT_GT(refused, 5000);
  EXPECT_LT(refused, 18000);
}

}  // namespace
}  // namespace calot::recorder::stl_test
