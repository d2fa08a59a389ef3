// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/fallen_clips.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace calot::recorder {
namespace {

constexpr double step = 0.01;
constexpr double width = ClipDescription().width;

/// A square of 10 cm around the axis at this height, tilted about x.
SceneView ground(double height, double tilt = 0.0) {
  SceneView view;
  view.down = -Vec3::UnitZ();
  SurfaceView& surface = view.surface.emplace_back();
  for (const auto& [x, y] : {std::pair{-0.05, -0.05}, {0.05, -0.05}, {0.05, 0.05}, {-0.05, 0.05}})
    surface.position.emplace_back(x, y, height + std::tan(tilt) * y);
  surface.triangle = {Index3(0, 1, 2), Index3(0, 2, 3)};
  return view;
}

Event lost(std::uint64_t at, const Vec3& where) {
  Event event;
  event.step = at;
  event.kind = EventKind::clipDropped;
  event.position = where;
  return event;
}

std::vector<ClipView> shown(const FallenClips& clips, SceneView view, double time) {
  view.time = time;
  clips.show(view);
  return view.clip;
}

TEST(FallenClips, FallFreelyAndLieFlat) {
  FallenClips clips({}, step);
  Event set = lost(10, Vec3::Zero());
  set.kind = EventKind::clipSet;
  clips.add(set);
  clips.add(lost(99, Vec3(0.01, 0.02, 0.0)));
  EXPECT_TRUE(shown(clips, ground(-0.05), 0.99).empty()) << "not yet, and a clip on a vessel does not fall";
  double before = std::numeric_limits<double>::infinity();
  for (const double age : {0.0, 0.02, 0.05, 0.09}) {
    const auto falling = shown(clips, ground(-0.05), 1.0 + age);
    ASSERT_EQ(falling.size(), 1U);
    EXPECT_NEAR(falling[0].pose.position.z(), 0.5 * width - 0.5 * 9.81 * age * age, 1e-12);
    EXPECT_LT(falling[0].pose.position.z(), before);
    before = falling[0].pose.position.z();
  }
  constexpr double tilt = 0.3;
  for (const double later : {1.2, 2.0, 100.0}) {
    const auto lying = shown(clips, ground(-0.05, tilt), later);
    ASSERT_EQ(lying.size(), 1U);
    const Vec3 normal(0.0, -std::sin(tilt), std::cos(tilt));
    const Vec3 under = Vec3(0.01, 0.02, -0.05 + std::tan(tilt) * 0.02);
    EXPECT_LT((lying[0].pose.position - under - 0.5 * width * normal).norm(), 1e-12);
    EXPECT_LT((lying[0].pose.orientation * Vec3::UnitZ() - normal).norm(), 1e-9) << "its width stands on the surface";
    EXPECT_EQ(lying[0].width, width);
    EXPECT_EQ(lying[0].legs, ClipDescription().legs);
  }
}

TEST(FallenClips, LieOnTheHighestSurfaceThatFacesThem) {
  FallenClips clips({}, step);
  clips.add(lost(0, Vec3::Zero()));
  SceneView view = ground(-0.08);
  SurfaceView above = ground(-0.03).surface[0], underside = ground(-0.02).surface[0];
  for (Index3& t : underside.triangle) std::swap(t[0], t[1]);
  view.surface.push_back(above);
  view.surface.push_back(underside);
  view.surface.push_back(ground(0.01).surface[0]);
  const auto lying = shown(clips, view, 5.0);
  ASSERT_EQ(lying.size(), 1U);
  EXPECT_NEAR(lying[0].pose.position.z(), -0.03 + 0.5 * width, 1e-12);
  view.surface[1].position[2].z() = view.surface[1].position[0].z() = -0.04;
  EXPECT_LT(shown(clips, view, 5.0)[0].pose.position.z(), -0.03) << "it moves with what it lies on";
}

TEST(FallenClips, FallDeepWhereNothingIsBelow) {
  FallenClips clips({}, step);
  clips.add(lost(99, Vec3(0.5, 0.0, 0.0)));
  clips.add(lost(99, Vec3(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0)));
  EXPECT_EQ(shown(clips, ground(-0.05), 1.1).size(), 1U);
  const auto fallen = shown(clips, ground(-0.05), 2.0);
  ASSERT_EQ(fallen.size(), 1U);
  EXPECT_NEAR(fallen[0].pose.position.z(), -0.25 + 0.5 * width, 1e-12);
}

TEST(FallenClips, AreFewWhateverARecordingSays) {
  FallenClips clips({}, step);
  for (std::uint64_t i = 0; i < 100000; ++i) clips.add(lost(0, Vec3::Zero()));
  SceneView view = ground(-0.05);
  view.surface[0].triangle.emplace_back(0, 1, 4);
  view.surface[0].triangle.emplace_back(-1, 1, 2);
  const auto lying = shown(clips, view, 5.0);
  EXPECT_LT(lying.size(), 100U);
  for (const ClipView& clip : lying) EXPECT_NEAR(clip.pose.position.z(), -0.05 + 0.5 * width, 1e-12);
}

TEST(FallenClips, NoTwoLieAlike) {
  FallenClips clips({}, step);
  for (std::uint64_t i = 0; i < 3; ++i) clips.add(lost(i, Vec3::Zero()));
  const auto lying = shown(clips, ground(-0.05), 5.0);
  ASSERT_EQ(lying.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(lying[i].pose.orientation.norm(), 1.0, 1e-12);
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_GT(lying[i].pose.orientation.angularDistance(lying[j].pose.orientation), 0.3);
  }
}

}  // namespace
}  // namespace calot::recorder
