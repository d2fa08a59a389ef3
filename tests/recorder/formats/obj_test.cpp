// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/mesh_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "sim/math/random.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;

TriangleMesh parse(const std::string& text, LengthUnit unit = LengthUnit::metre, const SurfaceLimits& limits = {}) {
  return parseSurface(std::as_bytes(std::span(text.data(), text.size())), "t.obj", unit, limits);
}

std::optional<Error> refusal(const std::string& text, const SurfaceLimits& limits = {}) {
  return caught([&] { parse(text, LengthUnit::metre, limits); });
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, ReadsTheFormsOfAFace) {
  for (const char* face :
       {"f 1 2 3 4", "f 1/1 2/2 3/3 4/4", "f 1//9 2//9 3//9 4//9", "f 1/1/9 2/1/9 3/1/9 4/1/9", "f -4 -3 -2 -1",
        "f 1// 2// 3/ 4/5/", "f 1 \\\n2 3\\\r\n 4", "mtllib c:\\a\\\n# \\\nf 1 2 3 4",
        "f -4//-1 2 -2/7 4 # and a comment", "  f\t1  2\t3 4  \r"}) {
    const TriangleMesh mesh = parse(square + face + "\n");
    ASSERT_EQ(mesh.triangles(), 2) << face;
    EXPECT_EQ(mesh.triangle[0], Index3(0, 1, 2)) << face;
    EXPECT_EQ(mesh.triangle[1], Index3(0, 2, 3)) << face;
  }
}

TEST(Obj, ScalesToMetresAndPassesOverDrawing) {
  const std::string text =
      "# comment\nmtllib x.mtl\no liver\ng a b\ns off\nusemtl red\nvt 0 0\nvn 0 0 1\nv 1 2 3 1.0\nv 4e0 +5 6 0.1 0.2 "
      "0.3\nv 7 "
      "8 -9.5\n\nl 1 2\nf 1 2 3";
  const TriangleMesh mesh = parse(text, LengthUnit::millimetre);
  EXPECT_EQ(mesh.vertex[1], Vec3(4.0 * 0.001, 5.0 * 0.001, 6.0 * 0.001));
  EXPECT_EQ(parse(text, LengthUnit::centimetre).vertex[2][2], -9.5 * 0.01);
  EXPECT_EQ(parseLengthUnit("cm"), LengthUnit::centimetre);
  EXPECT_THROW(parseLengthUnit("inch"), Error);
}

TEST(Obj, ConcavePolygonsAreCutInsideThem) {
  // An arrow: a fan from its first corner lies beside it. Only the corner beside the notch would do.
  for (const char* face : {"f 1 2 3 4", "f 2 3 4 1", "f 3 4 1 2", "f 4 1 2 3", "f 4 3 2 1"}) {
    std::vector<std::string> notes;
    const std::string text = std::string("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\n") + face + "\n";
    const TriangleMesh mesh =
        parseSurface(std::as_bytes(std::span(text.data(), text.size())), "t.obj", LengthUnit::metre, {}, &notes);
    ASSERT_EQ(mesh.triangles(), 2);
    EXPECT_NEAR(surfaceArea(mesh), 4.0, 1e-15) << face;
    EXPECT_TRUE(notes.empty());
  }
  std::vector<std::string> notes;
  const std::string bow = "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 3 0\nf 1 2 3 4\n";
  parseSurface(std::as_bytes(std::span(bow.data(), bow.size())), "t.obj", LengthUnit::metre, {}, &notes);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].substr(0, 2), "1 ");
}

TEST(Obj, VerticesThatAreFarAwayMayBeUnused) {
  const TriangleMesh mesh = parse("v 1e9 0 0\n" + square + "v 7 7 7\nf 2 3 4\n");
  ASSERT_EQ(mesh.vertices(), 3);
  EXPECT_EQ(mesh.triangle[0], Index3(0, 1, 2));
}

TEST(Obj, FacesMayComeBeforeTheirVertices) { EXPECT_EQ(parse("f 1 2 3\n" + square).triangles(), 1); }

TEST(Obj, RefusesWithTheLine) {
  const std::string ok = square + "f 1 2 3\n";
  EXPECT_FALSE(refusal(ok));
  const BadInput bad[] = {
      {"v 1 2", "t.obj: line 6", {"2", "3"}},
      {"v 1 2 nan", "t.obj: line 6", {"\"nan\""}},
      {"v 1 inf 2", "t.obj: line 6", {"\"inf\""}},
      {"v 1 2 1e999", "t.obj: line 6", {"\"1e999\""}},
      {"v 1 2 3x", "t.obj: line 6", {"\"3x\""}},
      {"v 1,5 2 3", "t.obj: line 6", {"\"1,5\""}},
      {"v 1 2 5000\nf 1 2 5", "t.obj: line 6", {"5000"}},
      {"v 0x10 2 3", "t.obj: line 6", {"\"0x10\""}},
      {"f 1 2 5", "t.obj: line 6", {"5", "4"}},
      {"f 1 2 0", "t.obj: line 6", {"0", "1"}},
      {"f 1 2 -5", "t.obj: line 6", {"-5", "4"}},
      {"f 1 2", "t.obj: line 6", {"2"}},
      {"f", "t.obj: line 6", {"0"}},
      {"f 1 2 3/x", "t.obj: line 6", {"\"x\""}},
      {"f 1 2 3/1/1/1", "t.obj: line 6", {"\"1/1\""}},
      {"f 1 2 99999999999", "t.obj: line 6", {"\"99999999999\""}},
      {"f 1 2 1.5", "t.obj: line 6", {"\"1.5\""}},
      {"curv 0 1 1 2", "t.obj: line 6", {"\"curv\""}},
      {"f 1 2 \\", "t.obj: line 6", {"\\"}},
      {"\x89PNG", "t.obj: line 6", {"\"?PNG\""}},
  };
  for (const auto& [line, where, values] : bad)
    expectFault(ErrorKind::damaged, where, values, refusal(ok + line + "\n"));
  expectFault(ErrorKind::damaged, "t.obj: line 6", {"zero"}, refusal(ok + std::string(1, '\0')));
  expectFault(ErrorKind::damaged, "t.obj", {}, refusal(""));
  expectFault(ErrorKind::damaged, "t.obj", {}, refusal(square));
  EXPECT_NE(refusal("")->fault(), refusal(square)->fault());
}

TEST(Obj, RefusesTooMuch) {
  SurfaceLimits limits;
  limits.vertices = 3;
  expectFault(ErrorKind::damaged, "t.obj: line 4", {"3"}, refusal(square, limits));
  limits = {};
  limits.triangles = 1;
  expectFault(ErrorKind::damaged, "t.obj: line 5", {"1"}, refusal(square + "f 1 2 3 4", limits));
  limits = {};
  limits.bytes = 10;
  expectFault(ErrorKind::damaged, "t.obj", {"10"}, refusal(square, limits));
}

TEST(Obj, DamagedBytesAreReadOrRefusedButNeverMore) {
  const std::string ok = square + "vn 0 0 1\nf 1//1 2//1 3//1 4//1\n# end\n";
  const std::uint64_t seed = 31337;
  SCOPED_TRACE(seed);
  Random random(seed);
  int refused = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::string text = ok.substr(0, trial % 3 == 0 ? random.next() % ok.size() : ok.size());
    for (auto flips = random.next() % 4; flips > 0 && !text.empty(); --flips) {
      char& c = text[random.next() % text.size()];
      c = static_cast<char>(static_cast<unsigned char>(c) ^ (1U << (random.next() % 8)));
    }
    try {
      const TriangleMesh mesh = parse(text);
      for (const Index3& v : mesh.triangle) ASSERT_TRUE(v.minCoeff() >= 0 && v.maxCoeff() < mesh.vertices());
      for (const Vec3& p : mesh.vertex) ASSERT_TRUE(p.allFinite());
    } catch (const Error& error) {
      ASSERT_EQ(error.kind(), ErrorKind::damaged);
      ++refused;
    }
  }
  EXPECT_GT(refused, 5000);
}

class ObjFile : public testing::Test {
 protected:
  void SetUp() override {
    const testing::TestInfo* info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::temp_directory_path() / (std::string("calot-obj-") + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(ObjFile, RoundTripIsExact) {
  Random random(1);
  TriangleMesh mesh;
  for (int i = 0; i < 300; ++i) {
    mesh.vertex.emplace_back(random.uniform(-1.0, 1.0), random.uniform(-1e-9, 1e-9), 1.0 / 3.0 * i);
  }
  for (int i = 0; i + 2 < 300; ++i) mesh.triangle.emplace_back(i, i + 1, i + 2);
  writeText(folder_ / "a.obj", formatObj(mesh, "first\nsecond"), false);
  const TriangleMesh back = readSurface(folder_ / "a.obj", LengthUnit::metre);
  ASSERT_EQ(back.vertex.size(), mesh.vertex.size());
  for (std::size_t i = 0; i < mesh.vertex.size(); ++i) EXPECT_EQ(back.vertex[i], mesh.vertex[i]);
  for (std::size_t i = 0; i < mesh.triangle.size(); ++i) EXPECT_EQ(back.triangle[i], mesh.triangle[i]);
}

TEST_F(ObjFile, OverwritesOnlyWhenTold) {
  const TriangleMesh mesh = parse(square + "f 1 2 3\n");
  const fs::path file = folder_ / "a.obj";
  std::ofstream(file) << "mine";
  expectFault(ErrorKind::invalid, file.string(), {}, [&] { writeText(file, formatObj(mesh, ""), false); },
              {Remedy::replaceExisting});
  EXPECT_EQ(fs::file_size(file), 4U);
  writeText(file, formatObj(mesh, ""), true);
  EXPECT_EQ(readSurface(file, LengthUnit::metre).triangles(), 1);
  EXPECT_FALSE(fs::exists(folder_ / "a.obj.part"));
  EXPECT_THROW(writeText(folder_ / "no" / "a.obj", formatObj(mesh, ""), true), Error);
  EXPECT_THROW(writeText(folder_, formatObj(mesh, ""), true), Error);
}

TEST_F(ObjFile, MissingAndFolderAreRefused) {
  for (const fs::path& path : {folder_ / "none.obj", folder_}) {
    expectFault(ErrorKind::damaged, "", {path.string()}, [&] { readSurface(path, LengthUnit::metre); });
  }
}

}  // namespace
}  // namespace calot::recorder
