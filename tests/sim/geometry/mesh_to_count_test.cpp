// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/isosurface_stuffing.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "recorder/formats/mesh_file.h"
#include "sim/geometry/surface_report.h"
#include "tests/sim/geometry/surfaces.h"
#include "tests/support/message.h"

namespace calot::mesh_to_count_test {
namespace {

constexpr double degree = 3.14159265358979323846 / 180.0;

/// What every good answer promises.
void expectPromises(const TriangleMesh& surface, int requested, const StuffedMesh& stuffed) {
  SCOPED_TRACE(testing::Message() << requested << " tetrahedra");
  ASSERT_TRUE(stuffed.ok()) << stuffed.error;
  const auto count = static_cast<double>(stuffed.mesh.tetrahedron.size());
  EXPECT_NEAR(count, requested, 0.15 * requested);
  EXPECT_NEAR(meshVolume(stuffed.mesh), signedVolume(surface), 0.01 * signedVolume(surface));
  const DihedralRange range = dihedralRange(stuffed.mesh);
  EXPECT_GE(range.min / degree, 10.6);
  EXPECT_LE(range.max / degree, 164.8);
  EXPECT_EQ(stuffed.report.tetrahedra, static_cast<int>(stuffed.mesh.tetrahedron.size()));
  EXPECT_EQ(stuffed.report.meshVolume, meshVolume(stuffed.mesh));
  EXPECT_EQ(stuffed.report.lostComponents, 0);
  const SurfaceReport boundary = inspectSurface(boundarySurface(stuffed.mesh));
  EXPECT_EQ(boundary.openEdges, 0);
  EXPECT_EQ(boundary.flippedEdges, 0);
  EXPECT_EQ(boundary.components, 1);
}

TriangleMesh organ(const std::string& name) {
  return recorder::readSurface(fmt::format("{}/assets/organs/{}", CALOT_SOURCE_DIR, name), recorder::LengthUnit::metre);
}

TEST(StuffToCount, LiverAtManyCounts) {
  const TriangleMesh liver = organ("liver.obj");
  for (const int requested : {100, 265, 518, 817, 1489, 1500, 5000, 10615}) {
    const StuffedMesh stuffed = stuffToCount(liver, requested);
    expectPromises(liver, requested, stuffed);
    EXPECT_LT(stuffed.report.meshToSurface, 0.75 * stuffed.cellSize);
  }
}

TEST(StuffToCount, GallbladderAtManyCounts) {
  const TriangleMesh gallbladder = organ("gallbladder.obj");
  for (const int requested : {50, 108, 121, 265, 470, 817, 3000}) {
    expectPromises(gallbladder, requested, stuffToCount(gallbladder, requested));
  }
  // The duct is 5 mm wide: a coarse mesh cannot follow it, and says so.
  const StuffingReport coarse = stuffToCount(gallbladder, 121).report;
  EXPECT_GE(coarse.lostParts, 1);
  EXPECT_GT(coarse.lostArea, 0.01);
  EXPECT_LT(coarse.lostWhere[1], -0.02);
}

TEST(StuffToCount, SameInputSameBits) {
  const TriangleMesh gallbladder = organ("gallbladder.obj");
  const StuffedMesh a = stuffToCount(gallbladder, 470);
  const StuffedMesh b = stuffToCount(gallbladder, 470);
  ASSERT_EQ(a.mesh.vertex.size(), b.mesh.vertex.size());
  for (std::size_t i = 0; i < a.mesh.vertex.size(); ++i) EXPECT_EQ(a.mesh.vertex[i], b.mesh.vertex[i]);
  for (std::size_t i = 0; i < a.mesh.tetrahedron.size(); ++i) EXPECT_EQ(a.mesh.tetrahedron[i], b.mesh.tetrahedron[i]);
}

TEST(StuffToCount, UnitDoesNotMatter) {
  TriangleMesh small = organ("gallbladder.obj");
  for (Vec3& p : small.vertex) p *= 1.0 / 1024.0;  // exact: the same mesh, smaller
  const StuffedMesh stuffed = stuffToCount(small, 300);
  expectPromises(small, 300, stuffed);
}

TEST(StuffToCount, LiverFromElsewhere) {
  const char* set = std::getenv("CALOT_SHARED_DATA");
  const std::filesystem::path folder =
      set != nullptr ? std::filesystem::path(set) : std::filesystem::path(CALOT_SOURCE_DIR) / "../shared/data";
  const std::filesystem::path file = folder / "meshes" / "liver-smooth.obj";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "needs meshes/liver-smooth.obj; set CALOT_SHARED_DATA";
  const TriangleMesh liver = recorder::readSurface(file, recorder::LengthUnit::centimetre);
  for (const int requested : {500, 1500, 3300, 7300}) {
    const StuffedMesh stuffed = stuffToCount(liver, requested);
    expectPromises(liver, requested, stuffed);
    // It folds through itself: with signs from pseudonormals the mesh strayed two cells from the surface here.
    EXPECT_LT(stuffed.report.meshToSurface, 0.75 * stuffed.cellSize);
  }
}

TEST(StuffToCount, ThinPartsAndLostComponentsAreReported) {
  // A ball with a plate of a twentieth of a cell: the plate cannot be followed.
  const TriangleMesh ball = test::refinedSphere(Vec3::Zero(), 0.03, 4);
  const TriangleMesh plate = test::boxSurface({0.05, -0.02, -0.0001}, {0.09, 0.02, 0.0001});
  const StuffedMesh stuffed = stuffToCount(test::together(ball, plate), 400);
  ASSERT_TRUE(stuffed.ok()) << stuffed.error;
  EXPECT_EQ(stuffed.report.lostComponents, 1);
  EXPECT_GE(stuffed.report.lostParts, 1);
  EXPECT_GT(stuffed.report.lostWhere[0], 0.05);
}

TEST(StuffToCount, TwoBodiesStayTwo) {
  const TriangleMesh both =
      test::together(test::refinedSphere({-0.04, 0.0, 0.0}, 0.03, 3), test::refinedSphere({0.04, 0.0, 0.0}, 0.03, 3));
  const StuffedMesh stuffed = stuffToCount(both, 600);
  ASSERT_TRUE(stuffed.ok()) << stuffed.error;
  int count = 0;
  static_cast<void>(tetrahedronComponents(stuffed.mesh, count));
  EXPECT_EQ(count, 2);
  EXPECT_EQ(stuffed.report.lostComponents, 0);
}

TEST(StuffToCount, RefusesWhatItCannotDo) {
  const TriangleMesh box = test::boxSurface(-Vec3::Ones(), Vec3::Ones());
  EXPECT_FALSE(stuffToCount(box, 11).ok());
  EXPECT_FALSE(stuffToCount(box, -5).ok());
  EXPECT_FALSE(stuffToCount(box, maxTetrahedronCount + 1).ok());
  EXPECT_TRUE(stuffToCount({}, 500).unusable);

  TriangleMesh open = box, flipped = box, notFinite = box;
  open.triangle.pop_back();
  std::swap(flipped.triangle[0][0], flipped.triangle[0][1]);
  notFinite.vertex[3][1] = std::numeric_limits<double>::quiet_NaN();
  expectDistinct({stuffToCount(open, 500).error, stuffToCount(flipped, 500).error,
                  stuffToCount(test::turned(box), 500).error, stuffToCount(notFinite, 500).error});
  TriangleMesh flat = box;
  for (Vec3& p : flat.vertex) p[2] = 0.0;
  EXPECT_TRUE(stuffToCount(flat, 500).unusable);
  // A sheet 1 m wide and a micrometre thick, and a needle: no lattice of so few cells holds them.
  EXPECT_FALSE(stuffToCount(test::boxSurface({0.0, 0.0, 0.0}, {1.0, 1.0, 1e-6}), 500).ok());
  EXPECT_FALSE(stuffToCount(test::boxSurface({0.0, 0.0, 0.0}, {1.0, 1e-6, 1e-6}), 500).ok());
}

}  // namespace
}  // namespace calot::mesh_to_count_test
