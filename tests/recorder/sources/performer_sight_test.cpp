// SPDX-License-Identifier: GPL-3.0-or-later
// What a performer takes for gallbladder, bed, cystic vessels and fat: what has these roles in the scene.
#include "recorder/sources/operation_mind.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "recorder/formats/scene_file.h"

namespace calot::recorder {
namespace {

constexpr std::size_t worker = 1;

SceneDescription sceneOf(const std::string& name) {
  return loadScene(std::filesystem::path(CALOT_SOURCE_DIR) / "assets" / "scenes" / (name + ".json")).description;
}

std::vector<std::string> vesselsOf(const PerformerSight& sight) {
  std::vector<std::string> names;
  for (const PerformerSight::VesselPlan& vessel : sight.vessels()) names.push_back(vessel.name);
  return names;
}

const std::vector<std::string> cystic{"cystic-duct", "cystic-artery"};

TEST(PerformerSight, PlansByTheProcedure) {
  const PerformerSight whole(sceneOf("cholecystectomy"), worker);
  EXPECT_TRUE(whole.hasSpecimen() && whole.hasFat() && whole.divides());
  EXPECT_EQ(vesselsOf(whole), cystic);
  EXPECT_GT(whole.columns().size(), 10U);
  ASSERT_EQ(whole.spared().size(), 3U);
  EXPECT_EQ(whole.spared()[0].name, "bile-duct");
  const PerformerSight touch(sceneOf("touch-liver"), worker);
  EXPECT_FALSE(touch.hasSpecimen() || touch.hasFat() || touch.divides());
  const PerformerSight bed(sceneOf("dissect-bed"), worker);
  EXPECT_TRUE(bed.hasSpecimen());
  EXPECT_FALSE(bed.hasFat() || bed.divides());
  const PerformerSight fat(sceneOf("carve-fat"), worker);
  EXPECT_TRUE(fat.hasFat() && !fat.divides());
}

/// Tissue of other roles stands first in its list, and names and looks say nothing.
TEST(PerformerSight, PlansByRolesWhereThereIsNoProcedure) {
  SceneDescription scene = sceneOf("cholecystectomy");
  const PerformerSight before(scene, worker);
  scene.procedure = {};
  for (OrganDescription& organ : scene.organs) organ.appearance = "tissue";
  for (VesselDescription& vessel : scene.vessels) vessel.appearance = "tissue";
  ConnectiveDescription sheet = scene.connective[0];
  sheet.name = "sheet";
  sheet.role = StructureRole::other;
  scene.connective.insert(scene.connective.begin(), sheet);
  FatDescription other = scene.fat[0];
  other.name = "omentum";
  other.role = StructureRole::other;
  other.triangleDepth = 0.0;
  scene.fat.insert(scene.fat.begin(), other);
  const PerformerSight sight(scene, worker);
  EXPECT_EQ(vesselsOf(sight), cystic);
  EXPECT_EQ(sight.neck(), before.neck());
  EXPECT_EQ(sight.columns().size(), before.columns().size());
  EXPECT_TRUE(sight.divides()) << "in a scene with fat, for it has a bed";
}

TEST(PerformerSight, SeesNothingToDoWithoutRolesAndProcedure) {
  SceneDescription scene = sceneOf("cholecystectomy");
  scene.procedure = {};
  for (OrganDescription& one : scene.organs) one.role = StructureRole::other;
  for (VesselDescription& one : scene.vessels) one.role = StructureRole::other;
  for (ConnectiveDescription& one : scene.connective) one.role = StructureRole::other;
  for (FatDescription& one : scene.fat) one.role = StructureRole::other;
  const PerformerSight sight(scene, worker);
  EXPECT_FALSE(sight.hasSpecimen() || sight.hasFat() || sight.divides());
}

}  // namespace
}  // namespace calot::recorder
