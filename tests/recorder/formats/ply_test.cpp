// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/surface_bytes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "recorder/formats/mesh_file.h"
#include "sim/geometry/surface_report.h"
#include "sim/math/random.h"
#include "tests/support/fault.h"

namespace calot::recorder::ply_test {
namespace {

TriangleMesh parse(const std::string& bytes, LengthUnit unit = LengthUnit::metre, const SurfaceLimits& limits = {}) {
  return parseSurface(std::as_bytes(std::span(bytes.data(), bytes.size())), "t.ply", unit, limits);
}

std::optional<Error> refusal(const std::string& bytes, const SurfaceLimits& limits = {}) {
  return caught([&] { parse(bytes, LengthUnit::metre, limits); });
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

// A pyramid over a square: four triangles and a quadrilateral, with colours, normals and an element of its own.
const std::string pyramid =
    "ply\nformat ascii 1.0\ncomment a test\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nelement edge 1\nproperty int vertex1\nproperty list uchar int tags\nelement face 5\n"
    "property float quality\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 255\n1 0 0 255\n1 1 0 0\n0 1 0 0\n0.5 0.5 1 0\n"
    "7 2 8 9\n"
    "nan 4 3 2 1 0\n0.5 3 0 1 4\n0.5 3 1 2 4\n0.5 3 2 3 4\n0.5 3 3 0 4\n";

/// The same in bytes. @param big: most significant byte first
std::string inBytes(bool big, std::uint32_t faces = 5) {
  std::string bytes = "ply\nformat binary_" + std::string(big ? "big" : "little") + "_endian 1.0\nelement face " +
                      std::to_string(faces) +
                      "\nproperty list uint8 uint32 vertex_index\nproperty double quality\n"
                      "element vertex 5\nproperty double x\nproperty float64 y\nproperty float32 z\n"
                      "property int16 w\nend_header\n";
  const auto put = [&bytes, big](const auto& value) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof(value));
    if (big) std::reverse(raw.begin(), raw.end());
    bytes += raw;
  };
  const std::vector<std::vector<std::uint32_t>> corners{{3, 2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  for (const auto& face : corners) {
    put(static_cast<std::uint8_t>(face.size()));
    for (const std::uint32_t v : face) put(v);
    put(0.25);
  }
  const double xy[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5, 0.5}};
  for (int v = 0; v < 5; ++v) {
    put(xy[v][0]);
    put(xy[v][1]);
    put(v == 4 ? 1.0F : 0.0F);
    put(static_cast<std::int16_t>(-v));
  }
  return bytes;
}

TEST(Ply, TextAndBothBinaryFormsGiveTheSameSurface) {
  for (const std::string& bytes : {pyramid, inBytes(false), inBytes(true)}) {
    const TriangleMesh mesh = parse(bytes, LengthUnit::millimetre);
    ASSERT_EQ(mesh.vertices(), 5);
    ASSERT_EQ(mesh.triangles(), 6);
    EXPECT_EQ(mesh.vertex[4], Vec3(0.5 * 0.001, 0.5 * 0.001, 0.001));
    EXPECT_EQ(mesh.triangle[0], Index3(3, 2, 1));
    EXPECT_EQ(mesh.triangle[1], Index3(3, 1, 0));
    EXPECT_EQ(mesh.triangle[5], Index3(3, 0, 4));
    const SurfaceReport report = inspectSurface(mesh);
    EXPECT_TRUE(report.closedManifold());
    EXPECT_NEAR(report.volume, 1e-9 / 3.0, 1e-20);
  }
}

TEST(Ply, LinesMayEndAsOnWindows) {
  std::string text;
  for (const char c : pyramid) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(parse(text).triangles(), 6);
}

TEST(Ply, RefusesAHeaderWithTheLine) {
  const BadInput bad[] = {
      {"", "t.ply: line 1", {"\"ply\""}},
      {"plx\n", "t.ply: line 1", {"\"ply\""}},
      {"ply\nformat ascii 1.0\n", "t.ply: line 2", {"\"end_header\""}},
      {replaced(pyramid, "ascii 1.0", "ascii 2.0"), "t.ply: line 2", {"\"2.0\"", "1.0"}},
      {replaced(pyramid, "ascii", "utf8"),
       "t.ply: line 2",
       {"\"utf8\"", "ascii, binary_little_endian, binary_big_endian"}},
      {replaced(pyramid, "comment", "format ascii 1.0\ncomment"), "t.ply: line 3", {"\"format\""}},
      {replaced(pyramid, "comment", "property float x\ncomment"), "t.ply: line 3", {}},
      {replaced(pyramid, "comment", "remark"), "t.ply: line 3", {"\"remark\""}},
      {replaced(pyramid, "vertex 5", "vertex -5"), "t.ply: line 4", {"-5"}},
      {replaced(pyramid, "vertex 5", "vertex 5.5"), "t.ply: line 4", {"\"5.5\""}},
      {replaced(pyramid, "vertex 5", "vertex 99999999999999999999"), "t.ply: line 4", {"\"99999999999999999999\""}},
      {replaced(pyramid, "vertex 5", "vertex 6000000"), "t.ply: line 4", {"5000000"}},
      {replaced(pyramid, "face 5", "face 4000000000"), "t.ply: line 12", {"10000000"}},
      {replaced(pyramid, "element edge", "element vertex"), "t.ply: line 9", {"\"vertex\""}},
      {replaced(pyramid, "float y", "float x"), "t.ply: line 6", {"\"x\""}},
      {replaced(pyramid, "float y", "vec3 y"), "t.ply: line 6", {"\"vec3\""}},
      {replaced(pyramid, "float y", "float v"), "t.ply: line 15", {"\"y\""}},
      {replaced(pyramid, "float y", "list uchar float y"), "t.ply: line 15", {"\"y\""}},
      {replaced(pyramid, "list uchar int vertex_indices", "list float int vertex_indices"), "t.ply: line 14", {}},
      {replaced(pyramid, "list uchar int vertex_indices", "list uchar float vertex_indices"), "t.ply: line 15", {}},
      {replaced(pyramid, "list uchar int vertex_indices", "int vertex_indices"),
       "t.ply: line 15",
       {"\"vertex_indices\""}},
      {replaced(pyramid, "vertex_indices", "corners"), "t.ply: line 15", {"\"vertex_indices\""}},
      {replaced(pyramid, "element face 5\nproperty float quality\nproperty list uchar int vertex_indices\n",
                "element tristrips 1\nproperty list int int vertex_indices\n"),
       "t.ply: line 14",
       {}},
      {replaced(pyramid, "property int vertex1\nproperty list uchar int tags\n", ""), "t.ply: line 13", {"\"edge\""}},
      {std::string("ply\n\0\n", 6), "t.ply: line 2", {}},
  };
  for (const auto& [bytes, where, values] : bad) expectFault(ErrorKind::damaged, where, values, refusal(bytes));
}

TEST(Ply, RefusesABodyWithThePlace) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::string notANumber = inBytes(false);
  const std::size_t vertices = notANumber.size() - std::size_t{5} * 22;
  notANumber.replace(vertices + 22, 8, std::string(reinterpret_cast<const char*>(&nan), 8));
  std::string far = inBytes(false);
  const std::uint32_t index = 4000000000U;
  far.replace(far.find("end_header\n") + 12, 4, std::string(reinterpret_cast<const char*>(&index), 4));
  std::string beyond = inBytes(false);
  const std::uint32_t five = 5;
  beyond.replace(beyond.find("end_header\n") + 12, 4, std::string(reinterpret_cast<const char*>(&five), 4));
  const BadInput bad[] = {
      {replaced(pyramid, "1 1 0 0", "1 inf 0 0"), "t.ply: line 18", {"\"inf\""}},
      {replaced(pyramid, "1 1 0 0", "1 x 0 0"), "t.ply: line 18", {"\"x\""}},
      {replaced(pyramid, "1 1 0 0", "1 2000 0 0"), "t.ply: line 18", {"2000"}},
      {replaced(pyramid, "3 0 1 4", "2 0 1"), "t.ply: line 23", {"2"}},
      {replaced(pyramid, "3 0 1 4", "-3 0 1 4"), "t.ply: line 23", {"-3"}},
      {replaced(pyramid, "3 0 1 4", "3 0 1 -4"), "t.ply: line 23", {"-4"}},
      {replaced(pyramid, "3 0 1 4", "3 0 1.5 4"), "t.ply: line 23", {"1.5"}},
      {replaced(pyramid, "3 0 1 4", "3 0 1 5"), "t.ply: face 1", {"5", "0"}},
      {replaced(pyramid, "0.5 3 3 0 4\n", ""), "t.ply: line 25", {"4", "5"}},
      {replaced(pyramid, "3 3 0 4", "4000000000 3 0 4"), "t.ply: line 26", {"4", "5"}},
      {inBytes(false).substr(0, inBytes(false).size() - 1), "t.ply: vertex 4", {"5"}},
      {inBytes(true, 9999999), "t.ply: face 5", {}},
      {notANumber, "t.ply: vertex 1", {}},
      {far, "t.ply: face 0", {"4000000000", "5000000"}},
      {beyond, "t.ply: face 0", {"0", "5"}},
  };
  for (const auto& [bytes, where, values] : bad) expectFault(ErrorKind::damaged, where, values, refusal(bytes));
}

TEST(Ply, RefusesTooMuch) {
  SurfaceLimits limits;
  limits.triangles = 5;  // five faces, but one of them is a quadrilateral
  expectFault(ErrorKind::damaged, "t.ply: line 26", {"5"}, refusal(pyramid, limits));
  limits = {};
  limits.bytes = 100;
  expectFault(ErrorKind::damaged, "t.ply", {"100"}, refusal(pyramid, limits));
}

TEST(Ply, DamagedBytesAreReadOrRefusedButNeverMore) {
  const std::uint64_t seed = 4711;
  SCOPED_TRACE(seed);
  Random random(seed);
  int refused = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    const std::string ok = trial % 2 == 0 ? pyramid : inBytes(trial % 4 == 1);
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
  EXPECT_LT(refused, 19000);
}

TEST(SurfaceFile, TheNameSaysTheFormat) {
  const auto bytes = std::as_bytes(std::span(pyramid.data(), pyramid.size()));
  EXPECT_EQ(parseSurface(bytes, "a/b.PLY", LengthUnit::metre).triangles(), 6);
  EXPECT_EQ(surfaceNameFault("x.Stl") + surfaceNameFault("x.obj") + surfaceNameFault("x.OFF"), "");
  for (const char* name : {"x.vtk", "ply", "", "x.ply.gz"}) EXPECT_NE(surfaceNameFault(name), "") << name;
  EXPECT_THROW(parseSurface(bytes, "x.vtk", LengthUnit::metre), Error);
  EXPECT_THROW(parseSurface(bytes, "x.stl", LengthUnit::metre), Error);
}

}  // namespace
}  // namespace calot::recorder::ply_test
