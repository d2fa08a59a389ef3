// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <sstream>

#include "sim/geometry/closest_point_transform.h"
#include "tests/recorder/formats/support/scene_with_vessels.h"

namespace calot::recorder::test {
namespace {

TEST(SceneFat, everyValueArrives) {
  const LoadedScene loaded = load(sceneWithVessels());
  EXPECT_TRUE(loaded.warnings.empty());
  ASSERT_EQ(loaded.description.fat.size(), 1U);
  const FatDescription& fat = loaded.description.fat[0];
  EXPECT_EQ(fat.name, "pad");
  EXPECT_EQ(fat.appearance, "fat");
  EXPECT_EQ(fat.surface.vertex.size(), 4U);
  EXPECT_EQ(fat.surface.vertex[1], Vec3(20 * 0.001, 0, 0));
  EXPECT_EQ(fat.cellSize, 0.001);
  EXPECT_EQ(fat.cellsPerCube, 2U);
  EXPECT_EQ(fat.material.youngModulus, 1500.0);
  EXPECT_EQ(fat.material.poissonRatio, 0.3);
  EXPECT_EQ(fat.friction, 0.3);
  ASSERT_EQ(fat.attachments.size(), 2U);
  EXPECT_EQ(fat.attachments[0].to, "liver");
  EXPECT_EQ(fat.attachments[0].distance, 0.002);
  EXPECT_EQ(fat.attachments[1].to, "branch");
  EXPECT_EQ(fat.attachments[1].stiffness, 2e8);
  EXPECT_EQ(fat.attachments[1].damping, 0.0);
}

TEST(SceneFat, everyFaultIsNamedWithItsPlace) {
  const std::vector<Change> changes{
      {"/fat/0/cellSize", "0", "/fat/0/cellSize", {"0", "[0.0001, 0.01]"}},
      {"/fat/0/cellSize", "-0.001", "/fat/0/cellSize", {"-0.001", "[0.0001, 0.01]"}},
      {"/fat/0/cellSize", "0.008", "/fat/0/cellSize", {"2", "4", "496", "16000000"}},
      {"/fat/0/cellsPerCube", "0", "/fat/0/cellsPerCube", {"0", "[1, 8]"}},
      {"/fat/0/material/poissonRatio", "0.5", "/fat/0/material/poissonRatio", {"0.5", "[0, 0.5)"}},
      {"/fat/0/material/youngModulus", "-1500", "/fat/0/material/youngModulus", {"-1500", "[10, 1000000000]"}},
      {"/fat/0/mesh/file", "\"organs/g.obj\"", "/fat/0/mesh/file", {"\"organs/g.obj\""}},
      {"/fat/0/mesh/file", "\"organs/f.vtk\"", "/fat/0/mesh/file", {}},
      {"/fat/0/name", "\"liver\"", "/fat/0/name", {}},
      {"/fat/0/name", "\"branch\"", "/fat/0/name", {}},
      {"/fat/0/attachments/0/to", "\"spleen\"", "/fat/0/attachments/0/to", {}},
      {"/fat/0/attachments/0/to", "\"pad\"", "/fat/0/attachments/0/to", {}},
      {"/fat/0/attachments/1/to", "\"liver\"", "/fat/0/attachments/1", {"\"liver\""}},
      {"/fat/0/attachments/0/distance", "0", "/fat/0/attachments/0/distance", {"0", "(0, 0.05]"}},
      {"/fat/0/attachments/0/stiffness", "-1", "/fat/0/attachments/0/stiffness", {"-1", "(0, 1000000000000]"}},
      {"/fat/0/attachments/0/damping", "-1", "/fat/0/attachments/0/damping", {"-1", "[0, 10000000000]"}},
      {"/fat/0/attachments", "", "/fat/0", {"\"attachments\""}},
      {"/vessels", "[]", "/fat/0/attachments/1/to", {}},
  };
  for (const Change& change : changes) expectRefused(change);

  nlohmann::json many = sceneWithVessels();
  many["fat"][0]["mesh"]["unit"] = "cm";
  many["fat"][0]["cellSize"] = 0.0005;
  expectFault(ErrorKind::damaged, "scenes/small.json: /fat/0/cellSize", {"400", "4", "496", "16000000"},
              [&] { load(many); });
  nlohmann::json twice = sceneWithVessels();
  twice["fat"].push_back(twice["fat"][0]);
  expectFault(ErrorKind::damaged, "scenes/small.json: /fat/1/name", {}, [&] { load(twice); });
}

TEST(SceneFat, aSurfaceWithHolesIsRefused) {
  expectFault(ErrorKind::damaged, "organs/f.obj", {"3", "0", "fat"},
              [] { load(sceneWithVessels(), "v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 1 4 3\n"); });
}

TEST(SceneFat, whatCanBePutRightIsAndIsTold) {
  // Inside out, one triangle twice, and a corner given twice.
  const LoadedScene loaded =
      load(sceneWithVessels(),
           "v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nv 0 0 0\nf 1 2 3\nf 1 2 3\nf 5 4 2\nf 1 3 4\nf 2 4 3\n");
  ASSERT_EQ(loaded.warnings.size(), 1U) << loaded.warnings.at(0);
  expectNames(loaded.warnings[0], {"organs/f.obj", "1", "4"});
  const SurfaceDescription& surface = loaded.description.fat[0].surface;
  EXPECT_EQ(surface.vertex.size(), 4U);
  EXPECT_NEAR(signedVolume({surface.vertex, surface.triangle}), 8e-6 / 6.0, 1e-15);
  // An organ is not put right: its tetrahedra are made of the surface as it is.
  expectFault(ErrorKind::damaged, "organs/a.obj", {"organ"}, [] {
    sceneFromAssets({{"scenes/small.json", bytesOf(sceneWithVessels().dump())},
                     {"organs/a.obj", bytesOf("v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 2 3\nf 1 4 2\nf 1 3 "
                                              "4\nf 2 4 3\n")},
                     {"organs/f.obj", bytesOf(fatText)}});
  });
}

TEST(SceneFat, aSurfaceThatPassesThroughItselfIsTakenForWhatItWindsAroundAndThatIsTold) {
  // Two boxes of 10 mm that overlap by half, each closed.
  std::ostringstream text;
  for (int box = 0; box < 2; ++box) {
    for (int i = 0; i < 8; ++i) {
      text << "v " << (i & 1) * 10 + 5 * box << " " << (i >> 1 & 1) * 10 + 2 * box << " " << (i >> 2) * 10 + 2 * box
           << "\n";
    }
    for (const auto& q :
         {std::array<int, 4>{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}) {
      text << "f";
      for (const int v : q) text << " " << v + 8 * box;
      text << "\n";
    }
  }
  const LoadedScene loaded = load(sceneWithVessels(), text.str());
  ASSERT_EQ(loaded.warnings.size(), 1U) << loaded.warnings.at(0);
  expectNames(loaded.warnings[0], {"organs/f.obj"});

  // With one triangle turned nothing tells any more what is inside.
  std::string turned = text.str();
  turned.replace(turned.find("f 1 3 4 2"), 9, "f 1 2 4 3");
  expectFault(ErrorKind::damaged, "organs/f.obj", {}, [&] { load(sceneWithVessels(), turned); });

  // The potential field that carving starts from does so: its inside is the union.
  const SurfaceDescription& surface = loaded.description.fat[0].surface;
  const TriangleMesh mesh{surface.vertex, surface.triangle};
  const double cell = 0.00025;
  const BrickLattice lattice = BrickLattice::around(bounds(mesh), cell, 4);
  const DistanceTransform field = closestPointTransform(mesh, lattice, 3.0);
  ASSERT_EQ(field.error, "");
  double inside = 0.0;
  for (int z = 0; z < lattice.nodes()[2]; ++z) {
    for (int y = 0; y < lattice.nodes()[1]; ++y) {
      for (int x = 0; x < lattice.nodes()[0]; ++x) inside += field.value[lattice.node({x, y, z})] < 0.0 ? 1.0 : 0.0;
    }
  }
  EXPECT_NEAR(inside * cell * cell * cell, 2e-6 - 5.0 * 8.0 * 8.0 * 1e-9, 0.04e-6);
}

}  // namespace
}  // namespace calot::recorder::test
