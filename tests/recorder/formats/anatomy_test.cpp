// SPDX-License-Identifier: GPL-3.0-or-later
// Ducts, arteries and fat of the scenes in assets/: what docs/explanation/organs.md and docs/reference/scenes.md say of
// them, in numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "recorder/formats/scene_file.h"
#include "sim/geometry/closest_point.h"
#include "sim/geometry/closest_point_transform.h"
#include "sim/geometry/surface_distance.h"
#include "sim/vessel/beam_model.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;

const std::array<const char*, 3> vesselScenes{"carve-fat", "clip-and-cut", "cholecystectomy"};

const LoadedScene& scene(const std::string& name) {
  static std::map<std::string, LoadedScene> loaded;
  const auto found = loaded.find(name);
  if (found != loaded.end()) return found->second;
  return loaded.emplace(name, loadScene(fs::path(CALOT_SOURCE_DIR) / "assets" / "scenes" / (name + ".json")))
      .first->second;
}

const SceneDescription& whole() { return scene("cholecystectomy").description; }

const SurfaceDistance& surfaceOf(const std::string& name) {
  static std::map<std::string, SurfaceDistance> made;
  if (const auto found = made.find(name); found != made.end()) return found->second;
  const SurfaceDescription* surface = &whole().fat.at(0).surface;
  for (const OrganDescription& organ : whole().organs) {
    if (organ.name == name) surface = &organ.surface;
  }
  return made.emplace(name, SurfaceDistance(TriangleMesh{surface->vertex, surface->triangle})).first->second;
}

const VesselDescription& vessel(const std::string& name) {
  for (const VesselDescription& one : whole().vessels) {
    if (one.name == name) return one;
  }
  throw std::logic_error("no vessel " + name);
}

std::vector<Vec3> nodes(const VesselDescription& one) { return evenNodes(one.path, one.elements); }

double lengthOf(const VesselDescription& one) {
  double sum = 0.0;
  const std::vector<Vec3> n = nodes(one);
  for (std::size_t i = 1; i < n.size(); ++i) sum += (n[i] - n[i - 1]).norm();
  return sum;
}

TEST(Anatomy, EverySceneThatComesWithItLoadsWithoutAWarning) {
  std::set<std::string> names;
  for (const fs::path& file : listScenes({fs::path(CALOT_SOURCE_DIR) / "assets"})) {
    const LoadedScene loaded = loadScene(file);
    EXPECT_EQ(loaded.description.name, file.stem().string());
    EXPECT_TRUE(loaded.warnings.empty()) << loaded.warnings.at(0);
    names.insert(loaded.description.name);
  }
  for (const char* name : {"touch-liver", "carve-fat", "clip-and-cut", "dissect-bed", "cholecystectomy"}) {
    EXPECT_EQ(names.count(name), 1U) << name;
  }
}

TEST(Anatomy, ScenesHoldTheSameVessels) {
  const std::vector<VesselDescription>& made = whole().vessels;
  ASSERT_EQ(made.size(), 5U);
  for (const char* name : vesselScenes) {
    const std::vector<VesselDescription>& held = scene(name).description.vessels;
    ASSERT_EQ(held.size(), made.size()) << name;
    for (std::size_t v = 0; v < made.size(); ++v) {
      SCOPED_TRACE(std::string(name) + " " + made[v].name);
      EXPECT_EQ(held[v].name, made[v].name);
      EXPECT_EQ(held[v].elements, made[v].elements);
      EXPECT_EQ(held[v].radius, made[v].radius);
      EXPECT_EQ(held[v].wall, made[v].wall);
      EXPECT_EQ(held[v].path, made[v].path);
    }
  }
}

TEST(Anatomy, EachSceneHasWhatItIsAbout) {
  const SceneDescription& carve = scene("carve-fat").description;
  const SceneDescription& clip = scene("clip-and-cut").description;
  EXPECT_EQ(carve.fat.size(), 1U);
  EXPECT_TRUE(clip.fat.empty());
  EXPECT_TRUE(carve.connective.empty() && clip.connective.empty());
  EXPECT_EQ(clip.hands[1].instrument, InstrumentKind::clipApplier);
  EXPECT_EQ(carve.hands[1].instrument, InstrumentKind::hook);
  ASSERT_EQ(whole().organs.size(), 2U);
  EXPECT_EQ(whole().organs[0].tetrahedra, 1489U);
  EXPECT_EQ(whole().organs[1].tetrahedra, 121U);
  EXPECT_TRUE(whole().organs[1].anchors.empty());
  ASSERT_EQ(whole().connective.size(), 1U);
  EXPECT_GE(whole().connective[0].strands, 200U);
  EXPECT_LE(whole().fat.at(0).cellSize, 0.00075);
}

TEST(Anatomy, SizesAreThoseOfTheLiterature) {
  EXPECT_NEAR(lengthOf(vessel("cystic-duct")), 0.030, 0.001);
  EXPECT_NEAR(lengthOf(vessel("cystic-artery")), 0.0286, 0.001);
  EXPECT_NEAR(lengthOf(vessel("bile-duct")), 0.053, 0.001);
  EXPECT_NEAR(lengthOf(vessel("hepatic-duct")), 0.083, 0.001);
  for (const VesselDescription& one : whole().vessels) {
    EXPECT_LT(lengthOf(one) / one.elements, 0.0026) << one.name;  // half a clip's width
  }
}

TEST(Anatomy, TubesKeepApartOutsideTheirJunctions) {
  const std::vector<VesselDescription>& all = whole().vessels;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::vector<Vec3> first = nodes(all[i]);
    for (std::size_t j = 0; j < i; ++j) {
      SCOPED_TRACE(all[i].name + " " + all[j].name);
      const std::vector<Vec3> second = nodes(all[j]);
      const double touch = all[i].radius + all[j].radius;
      // Tubes that meet are held apart from where their walls have parted by a millimetre; before, they are one.
      const bool meet = (first[0] - second.back()).norm() < 1e-6 || (first[0] - second[0]).norm() < 1e-6 ||
                        all[i].start.to == all[j].name;
      const double near = meet ? touch + 0.003 : 0.0;
      double least = 1.0;
      for (std::size_t s = 1; s < first.size(); ++s) {
        if ((first[s] - first[0]).norm() < near) continue;
        for (std::size_t t = 1; t < second.size(); ++t) {
          least = std::min(
              least, std::sqrt(closestSegments(first[s - 1], first[s], second[t - 1], second[t]).squaredDistance));
        }
      }
      EXPECT_GT(least, touch + 0.001);
    }
  }
  // What grows out of another vessel starts at one of its nodes.
  const std::vector<Vec3> artery = nodes(vessel("right-hepatic-artery"));
  double off = 1.0;
  for (const Vec3& p : artery) off = std::min(off, (p - vessel("cystic-artery").path.front()).norm());
  EXPECT_LT(off, 1e-6);
  EXPECT_EQ(vessel("hepatic-duct").path.front(), vessel("bile-duct").path.back());
  EXPECT_EQ(vessel("cystic-duct").path.front(), vessel("bile-duct").path.back());
}

TEST(Anatomy, TubesEnterOrgansWithTheirEndsAlone) {
  const std::map<std::string, std::string> enters{{"hepatic-duct", "liver"},
                                                  {"right-hepatic-artery", "liver"},
                                                  {"cystic-duct", "gallbladder"},
                                                  {"cystic-artery", "gallbladder"}};
  for (const VesselDescription& one : whole().vessels) {
    const std::vector<Vec3> n = nodes(one);
    for (const char* organ : {"liver", "gallbladder"}) {
      SCOPED_TRACE(one.name + " " + organ);
      const auto goal = enters.find(one.name);
      const bool ends = goal != enters.end() && goal->second == organ;
      std::size_t inside = 0;
      for (std::size_t i = 0; i < n.size(); ++i) {
        const bool in = surfaceOf(organ).signedDistance(n[i]) < one.radius;
        // Once in, it stays in to the end.
        EXPECT_TRUE(!in || ends);
        EXPECT_TRUE(in || inside == 0);
        inside += in ? 1 : 0;
      }
      EXPECT_EQ(inside > 0, ends);
      EXPECT_LE(inside, n.size() / 6);
      if (ends) {
        EXPECT_LT(surfaceOf(organ).signedDistance(n.back()), 0.0);
      }
    }
  }
}

TEST(Anatomy, FatCoversCysticDuctAndArteryAllAroundAndReachesIntoNoOrgan) {
  const SurfaceDistance& fat = surfaceOf("fat");
  for (const char* name : {"cystic-duct", "cystic-artery"}) {
    SCOPED_TRACE(name);
    const VesselDescription& one = vessel(name);
    const std::vector<Vec3> n = nodes(one);
    for (const Vec3& p : n) {
      // Between what it grows out of and the gallbladder: a third of a millimetre of fat and more on every side.
      const double fromStart = (p - n.front()).norm() - 0.004;
      if (fromStart < 0.0 || surfaceOf("gallbladder").signedDistance(p) < one.radius + 0.0015) continue;
      EXPECT_LT(fat.signedDistance(p), -(one.radius + 0.00033)) << fromStart;
    }
  }
  for (const Vec3& p : fat.mesh().vertex) {
    EXPECT_GT(surfaceOf("liver").signedDistance(p), -0.0005);
    EXPECT_GT(surfaceOf("gallbladder").signedDistance(p), -0.0005);
  }
  for (const char* organ : {"liver", "gallbladder"}) {
    for (const Vec3& p : surfaceOf(organ).mesh().vertex) ASSERT_GT(fat.signedDistance(p), -0.0005);
  }
  // It hangs on both organs, on the hepatic duct and on the right hepatic artery.
  for (const FatAttachmentDescription& attachment : whole().fat[0].attachments) {
    double least = 1.0;
    for (const Vec3& p : fat.mesh().vertex) {
      if (attachment.to == "liver" || attachment.to == "gallbladder") {
        least = std::min(least, surfaceOf(attachment.to).signedDistance(p));
      } else {
        const VesselDescription& one = vessel(attachment.to);
        for (const Vec3& q : nodes(one)) least = std::min(least, (p - q).norm() - one.radius);
      }
    }
    EXPECT_LT(least, attachment.distance) << attachment.to;
  }
}

// A clip closes 4 mm of the duct, three of them and a cut between leave room where nothing else is.
TEST(Anatomy, DuctAndArteryHaveRoomForThreeClipsAndACut) {
  for (const char* name : {"cystic-duct", "cystic-artery"}) {
    const VesselDescription& one = vessel(name);
    const std::vector<Vec3> n = nodes(one);
    const VesselDescription& from = vessel(one.start.to);
    double bare = 0.0;
    for (std::size_t i = 1; i < n.size(); ++i) {
      const bool off = (n[i] - n[0]).norm() > from.radius + one.radius;
      if (off && surfaceOf("gallbladder").signedDistance(n[i]) > one.radius) bare += (n[i] - n[i - 1]).norm();
    }
    EXPECT_GT(bare, 3 * 0.004 + 4 * 0.001 + 0.002) << name;
  }
}

// A straight shaft from the right hand's port reaches the middle of duct and artery, clear of both organs.
TEST(Anatomy, TheRightHandReachesDuctAndArtery) {
  for (const char* name : vesselScenes) {
    const SceneDescription& s = scene(name).description;
    for (const char* goal : {"cystic-duct", "cystic-artery"}) {
      SCOPED_TRACE(std::string(name) + " " + goal);
      const std::vector<Vec3> n = nodes(vessel(goal));
      const Vec3 target = n[n.size() / 2];
      EXPECT_TRUE((target.array() > s.workspace[0].array()).all() && (target.array() < s.workspace[1].array()).all());
      const Vec3 shaft = target - s.hands[1].port;
      EXPECT_LT(shaft.norm(), 0.18);
      for (int k = 0; k <= 50; ++k) {
        const Vec3 p = s.hands[1].port + (k / 50.0) * shaft;
        EXPECT_GT(surfaceOf("liver").signedDistance(p), s.hands[1].shaftRadius + 0.002) << k;
        EXPECT_GT(surfaceOf("gallbladder").signedDistance(p), s.hands[1].shaftRadius) << k;
      }
      // Across the vessel rather than along it.
      const Vec3 along = n[n.size() / 2 + 1] - n[n.size() / 2 - 1];
      EXPECT_LT(std::abs(along.dot(shaft)) / (along.norm() * shaft.norm()), 0.7);
    }
  }
}

TEST(Anatomy, TheFatFillsEnoughCubes) {
  const FatDescription& fat = whole().fat[0];
  const TriangleMesh mesh{fat.surface.vertex, fat.surface.triangle};
  const int edge = static_cast<int>(fat.cellsPerCube);
  const BrickLattice lattice = BrickLattice::around(bounds(mesh), fat.cellSize, 4, edge);
  const DistanceTransform field = closestPointTransform(mesh, lattice, 3.0);
  ASSERT_EQ(field.error, "");
  std::set<std::array<int, 3>> cubes;
  int inside = 0;
  for (int z = 0; z < lattice.nodes()[2]; ++z) {
    for (int y = 0; y < lattice.nodes()[1]; ++y) {
      for (int x = 0; x < lattice.nodes()[0]; ++x) {
        if (field.value[lattice.node({x, y, z})] >= 0.0) continue;
        ++inside;
        cubes.insert({x / edge, y / edge, z / edge});
      }
    }
  }
  EXPECT_GE(cubes.size(), 400U);
  EXPECT_NEAR(inside * fat.cellSize * fat.cellSize * fat.cellSize, signedVolume(mesh), 0.02 * signedVolume(mesh));
}

}  // namespace
}  // namespace calot::recorder
