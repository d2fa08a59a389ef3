// SPDX-License-Identifier: GPL-3.0-or-later
// The organs of assets/organs: what the program makes is what is kept, and it is anatomy.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "apps/calot-organs/organ_shapes.h"
#include "recorder/base/files.h"
#include "recorder/formats/surface_bytes.h"
#include "sim/geometry/surface_distance.h"
#include "sim/geometry/surface_report.h"

namespace calot {
namespace {

std::string kept(const std::string& name) {
  const auto bytes = recorder::readFileBytes(std::string(CALOT_SOURCE_DIR) + "/assets/organs/" + name, name, 1U << 24U);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

const TriangleMesh& liverMesh() {
  static const TriangleMesh mesh = organs::makeLiver();
  return mesh;
}

const TriangleMesh& gallbladderMesh() {
  static const TriangleMesh mesh = organs::makeGallbladder();
  return mesh;
}

TEST(Organs, ProgramMakesTheSameBytes) {
  EXPECT_TRUE(recorder::formatObj(liverMesh(), organs::headOf("Liver of an adult")) == kept("liver.obj"));
  EXPECT_TRUE(recorder::formatObj(gallbladderMesh(), organs::headOf("Gallbladder of an adult")) ==
              kept("gallbladder.obj"));
  EXPECT_TRUE(recorder::formatObj(organs::makeFat(), organs::headOf("Fat over Calot's triangle")) == kept("fat.obj"));
}

TEST(Organs, FatIsAPadOfOnePieceThatDoesNotCrossItself) {
  const TriangleMesh mesh = organs::makeFat();
  const SurfaceReport fat = inspectSurface(mesh);
  EXPECT_TRUE(fat.closedManifold());
  EXPECT_EQ(fat.components, 1);
  EXPECT_EQ(findSelfCrossing(mesh).pairs, 0U);
  EXPECT_TRUE(fat.volume > 3e-6 && fat.volume < 6e-6) << fat.volume;
  const Vec3 size = fat.box.upper - fat.box.lower;
  EXPECT_LT(size.maxCoeff(), 0.05);
  EXPECT_GT(size.minCoeff(), 0.03);
}

TEST(Organs, HavePlausibleSizes) {
  const SurfaceReport liver = inspectSurface(liverMesh());
  EXPECT_TRUE(liver.closedManifold());
  EXPECT_EQ(liver.components, 1);
  EXPECT_NEAR(liver.volume, 1.5e-3, 0.1e-3);
  const Vec3 size = liver.box.upper - liver.box.lower;
  EXPECT_TRUE(size[0] > 0.20 && size[0] < 0.23) << size[0];
  EXPECT_TRUE(size[1] > 0.10 && size[1] < 0.13) << size[1];
  EXPECT_TRUE(size[2] > 0.15 && size[2] < 0.18) << size[2];
  EXPECT_TRUE(liver.triangles >= 4000 && liver.triangles <= 8000);

  const SurfaceReport gallbladder = inspectSurface(gallbladderMesh());
  EXPECT_TRUE(gallbladder.closedManifold());
  EXPECT_EQ(gallbladder.components, 1);
  EXPECT_TRUE(gallbladder.volume > 30e-6 && gallbladder.volume < 50e-6) << gallbladder.volume;
  EXPECT_TRUE(gallbladder.triangles >= 2000 && gallbladder.triangles <= 4000);
}

TEST(Organs, GallbladderLiesInItsBed) {
  const TriangleMesh& liver = liverMesh();
  const TriangleMesh& gallbladder = gallbladderMesh();
  const SurfaceDistance toLiver(liver);
  const SurfaceDistance toGallbladder(gallbladder);
  double gap = 1.0;
  int inBed = 0;
  double bedFrom = 1.0;
  double bedTo = -1.0;
  for (const Vec3& p : gallbladder.vertex) {
    const double d = toLiver.signedDistance(p);
    gap = std::min(gap, d);
    if (d > 0.002) continue;
    ++inBed;
    bedFrom = std::min(bedFrom, p[1]);
    bedTo = std::max(bedTo, p[1]);
  }
  for (const Vec3& p : liver.vertex) gap = std::min(gap, toGallbladder.signedDistance(p));
  EXPECT_GT(gap, 0.0005);  // metres: they do not touch
  EXPECT_LT(gap, 0.002);
  EXPECT_GT(inBed, gallbladder.vertices() / 10);
  EXPECT_GT(bedTo - bedFrom, 0.04);  // the bed is long
  // The origin is near the middle of the bed: the liver is just above it, the gallbladder just below.
  EXPECT_LT(std::abs(toLiver.closest(Vec3::Zero()).on.point.norm()), 0.012);
  EXPECT_NEAR(0.5 * (bedFrom + bedTo), 0.015, 0.015);
}

TEST(Organs, FundusReachesPastTheInferiorBorder) {
  const Box liver = bounds(liverMesh());
  double border = -1.0;
  double fundus = -1.0;
  for (const Vec3& p : liverMesh().vertex) {
    if (std::abs(p[0] - 0.012) < 0.012 && p[2] < -0.005) border = std::max(border, p[1]);
  }
  for (const Vec3& p : gallbladderMesh().vertex) fundus = std::max(fundus, p[1]);
  EXPECT_GT(fundus, border);
  EXPECT_LT(fundus, liver.upper[1] + 0.02);
}

}  // namespace
}  // namespace calot
