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
      {"/fat/0/cellSize", "0", "/fat/0/cellSize: 0 is not in [0.0001, 0.01]"},
      {"/fat/0/cellSize", "-0.001", "/fat/0/cellSize: -0.001 is not in [0.0001, 0.01]"},
      {"/fat/0/cellSize", "0.008",
       "/fat/0/cellSize: the surface's box has 2 x 2 x 2 cells of this size; from 4 to 496 along each side and at most "
       "16000000 in all are allowed"},
      {"/fat/0/cellsPerCube", "0", "/fat/0/cellsPerCube: 0 is not in [1, 8]"},
      {"/fat/0/material/poissonRatio", "0.5", "/fat/0/material/poissonRatio: 0.5 is not in [0, 0.5)"},
      {"/fat/0/material/youngModulus", "-1500", "/fat/0/material/youngModulus: -1500 is not in [10, 1000000000]"},
      {"/fat/0/mesh/file", "\"organs/g.obj\"", "/fat/0/mesh/file: there is no asset \"organs/g.obj\""},
      {"/fat/0/mesh/file", "\"organs/f.vtk\"", "/fat/0/mesh/file: surfaces are read from .obj, .stl and .ply files"},
      {"/fat/0/name", "\"liver\"", "/fat/0/name: an organ has this name"},
      {"/fat/0/name", "\"branch\"", "/fat/0/name: a vessel has this name"},
      {"/fat/0/attachments/0/to", "\"spleen\"",
       "/fat/0/attachments/0/to: the scene has no organ and no vessel of this name"},
      {"/fat/0/attachments/0/to", "\"pad\"",
       "/fat/0/attachments/0/to: the scene has no organ and no vessel of this name"},
      {"/fat/0/attachments/1/to", "\"liver\"", "/fat/0/attachments/1: a second attachment to \"liver\""},
      {"/fat/0/attachments/0/distance", "0", "/fat/0/attachments/0/distance: 0 is not in (0, 0.05]"},
      {"/fat/0/attachments/0/stiffness", "-1", "/fat/0/attachments/0/stiffness: -1 is not in (0, 1000000000000]"},
      {"/fat/0/attachments/0/damping", "-1", "/fat/0/attachments/0/damping: -1 is not in [0, 10000000000]"},
      {"/fat/0/attachments", "", "/fat/0: the key \"attachments\" is missing"},
      {"/vessels", "[]", "/fat/0/attachments/1/to: the scene has no organ and no vessel of this name"},
  };
  for (const Change& change : changes) EXPECT_EQ(faultOf(change), change.message) << change.pointer;

  nlohmann::json many = sceneWithVessels();
  many["fat"][0]["mesh"]["unit"] = "cm";
  many["fat"][0]["cellSize"] = 0.0005;
  EXPECT_EQ(faultOf([&] { load(many); }),
            "scenes/small.json: /fat/0/cellSize: the surface's box has 400 x 400 x 400 cells of this size; from 4 to "
            "496 along each side and at most 16000000 in all are allowed");
  nlohmann::json twice = sceneWithVessels();
  twice["fat"].push_back(twice["fat"][0]);
  EXPECT_EQ(faultOf([&] { load(twice); }), "scenes/small.json: /fat/1/name: other fat has this name");
}

TEST(SceneFat, aSurfaceWithHolesIsRefused) {
  const std::string open =
      faultOf([] { load(sceneWithVessels(), "v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 1 4 3\n"); });
  EXPECT_EQ(open,
            "organs/f.obj: 3 triangles with 3 open edges, 0 edges of more than two triangles, 0 flipped edges and 0 "
            "parts turned inside out; fat is a closed outward surface");
}

TEST(SceneFat, whatCanBePutRightIsAndIsTold) {
  // Inside out, one triangle twice, and a corner given twice.
  const LoadedScene loaded =
      load(sceneWithVessels(),
           "v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nv 0 0 0\nf 1 2 3\nf 1 2 3\nf 5 4 2\nf 1 3 4\nf 2 4 3\n");
  ASSERT_EQ(loaded.warnings.size(), 1U) << loaded.warnings.at(0);
  EXPECT_EQ(loaded.warnings[0],
            "organs/f.obj: put right before use: 1 vertices welded, 1 duplicate triangles dropped, 4 triangles turned");
  const SurfaceDescription& surface = loaded.description.fat[0].surface;
  EXPECT_EQ(surface.vertex.size(), 4U);
  EXPECT_NEAR(signedVolume({surface.vertex, surface.triangle}), 8e-6 / 6.0, 1e-15);
  // An organ is not put right: its tetrahedra are made of the surface as it is.
  EXPECT_NE(
      faultOf([] {
        sceneFromAssets({{"scenes/small.json", bytesOf(sceneWithVessels().dump())},
                         {"organs/a.obj", bytesOf("v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 2 3\nf 1 4 2\nf 1 3 "
                                                  "4\nf 2 4 3\n")},
                         {"organs/f.obj", bytesOf(fatText)}});
      }).find("an organ is a closed outward surface"),
      std::string::npos);
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
  EXPECT_EQ(loaded.warnings[0].find("organs/f.obj: the surface passes through itself, as at ("), 0U)
      << loaded.warnings[0];
  EXPECT_NE(loaded.warnings[0].find("the region that it winds around is taken as its inside"), std::string::npos);

  // With one triangle turned nothing tells any more what is inside.
  std::string turned = text.str();
  turned.replace(turned.find("f 1 3 4 2"), 9, "f 1 2 4 3");
  const std::string fault = faultOf([&] { load(sceneWithVessels(), turned); });
  EXPECT_NE(fault.find("do not agree on what is outside: its inside cannot be determined"), std::string::npos) << fault;

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
