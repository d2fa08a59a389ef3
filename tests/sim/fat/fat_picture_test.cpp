// SPDX-License-Identifier: GPL-3.0-or-later
// The surface of fat for those who draw it: followed from stroke to stroke it is what a State gives by itself.
#include "sim/fat/fat_model.h"

#include <gtest/gtest.h>

#include "tests/sim/fat/support/fat_bodies.h"

namespace calot::fat_picture_test {
namespace {

std::unique_ptr<const FatModel> lump() {
  return test::fatOn(test::lumpSurface({0.012, 0.010, 0.006}), test::fatSettings(0.00075),
                     {test::floorPartner(-0.003)});
}

/// A step with a random stroke: the same for whoever asks.
void step(test::FatRig& rig, int i) {
  Random random(static_cast<std::uint64_t>(i), 23);
  rig.move({0.0, 0.0, -2.0}, std::vector<Vec3>(rig.model.solid().nodes(), Vec3::Zero()));
  const SweptCapsule tool[1] = {
      test::randomSweep(random, {{-0.013, -0.011, -0.002}, {0.013, 0.011, 0.007}}, 0.0015, 0.004, 0.003)};
  rig.body.stroke(rig.state, tool);
}

void expectSame(const FatPicture& a, const FatPicture& b, const FatState& state) {
  ASSERT_EQ(a.rest(), b.rest());
  ASSERT_EQ(a.triangles(), b.triangles());
  std::vector<Vec3> here, there;
  a.positions(state.solid.position, here);
  b.positions(state.solid.position, there);
  ASSERT_EQ(here, there);
}

TEST(FatPicture, FollowsStrokesAsIfEachStateWereMetFirst) {
  const auto model = lump();
  test::FatRig rig(*model);
  FatPicture followed(*model);
  EXPECT_FALSE(followed.update(rig.state.carved)) << "nothing is carved";
  std::vector<CarvedBricks> past;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    past.push_back(rig.state.carved);
    step(rig, i);
    if (i % 3 != 0) continue;  // several strokes at once
    followed.update(rig.state.carved);
    EXPECT_FALSE(followed.update(rig.state.carved)) << "nothing was carved since";
    FatPicture fresh(*model);
    fresh.update(rig.state.carved);
    ASSERT_NO_FATAL_FAILURE(expectSame(followed, fresh, rig.state));
  }
  EXPECT_NE(followed.rest(), FatPicture(*model).rest());
  for (const std::size_t back : {30U, 12U, 0U, 20U}) {
    FatPicture fresh(*model);
    fresh.update(past[back]);
    followed.update(past[back]);
    ASSERT_NO_FATAL_FAILURE(expectSame(followed, fresh, rig.state));
  }
}

TEST(FatPicture, AtRestItLiesAtRest) {
  const auto model = lump();
  const FatPicture picture(*model);
  std::vector<Vec3> places;
  picture.positions(restState(*model).solid.position, places);
  ASSERT_EQ(places.size(), picture.rest().size());
  ASSERT_FALSE(places.empty());
  for (std::size_t v = 0; v < places.size(); ++v) ASSERT_LT((places[v] - picture.rest()[v]).norm(), 1e-14);
}

}  // namespace
}  // namespace calot::fat_picture_test
