// SPDX-License-Identifier: GPL-3.0-or-later
// The field, its State and what follows from it.
#include "sim/carving/carved_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sim/math/fields.h"
#include "tests/sim/carving/support/carving_bodies.h"
#include "tests/support/message.h"

namespace calot {
namespace {

void carveSome(CarvedField& field, CarvedBricks& state, int strokes) {
  Random random(4, 4);
  const Box box{{-0.02, -0.015, -0.002}, {0.02, 0.015, 0.008}};
  for (int i = 0; i < strokes; ++i) {
    field.begin();
    test::carveAtRest(field, {test::randomSweep(random, box, 0.0015, 0.004, 0.002)});
    field.commit(state);
  }
}

TEST(CarvedField, StateIsEnoughToGetItBack) {
  const FieldModel model = test::lump(41);
  CarvedField field(model);
  CarvedBricks state;
  field.reserve(state);
  const std::size_t capacity = state.value.capacity();
  carveSome(field, state, 20);
  EXPECT_EQ(state.value.capacity(), capacity);  // no growth on the way
  EXPECT_LT(state.brick.size(), model.lattice.brickCount());

  std::vector<std::byte> bytes;
  ByteWriter(bytes).write(state);
  CarvedBricks read;
  ByteReader reader(bytes);
  reader.read(read);
  ASSERT_TRUE(reader.complete());
  CarvedField again(model);
  ASSERT_TRUE(again.restore(read));
  EXPECT_EQ(again.values(), field.values());
  EXPECT_EQ(test::insideNodes(again), test::insideNodes(field));
  // And both go on alike.
  carveSome(field, state, 5);
  carveSome(again, read, 5);
  EXPECT_EQ(again.values(), field.values());
  EXPECT_EQ(read.brick, state.brick);
  EXPECT_EQ(read.value, state.value);
}

TEST(CarvedField, IsRaisedToWhatWasCarvedSince) {
  const FieldModel model = test::lump(41);
  CarvedField field(model);
  CarvedBricks early;
  carveSome(field, early, 4);
  CarvedBricks late = early;
  carveSome(field, late, 20);
  CarvedField follower(model);
  ASSERT_TRUE(follower.raiseTo(early));
  ASSERT_TRUE(follower.raiseTo(late));
  EXPECT_EQ(follower.values(), field.values());
  EXPECT_EQ(test::insideNodes(follower), test::insideNodes(field));
  EXPECT_FALSE(follower.changed().empty());
  ASSERT_TRUE(follower.raiseTo(late));
  EXPECT_TRUE(follower.changed().empty());
  // It does not fall.
  EXPECT_FALSE(follower.raiseTo(early));
  EXPECT_FALSE(follower.raiseTo({}));
  EXPECT_EQ(follower.values(), field.values());
  CarvedBricks bad = late;
  bad.value[1][77] = std::nan("");
  EXPECT_FALSE(follower.raiseTo(bad));
  bad = late;
  bad.value[1][77] = 2.0 * model.band;
  EXPECT_FALSE(follower.raiseTo(bad));
  bad = late;
  bad.brick.back() = static_cast<std::uint32_t>(model.lattice.brickCount());
  EXPECT_FALSE(follower.raiseTo(bad));
  EXPECT_EQ(follower.values(), field.values());
}

TEST(CarvedField, RefusesForeignBricksAndStaysUncarved) {
  const FieldModel model = test::lump(41);
  CarvedField field(model);
  CarvedBricks good;
  carveSome(field, good, 3);
  const auto refused = [&](const CarvedBricks& bad) {
    CarvedField other(model);
    const bool taken = other.restore(bad);
    EXPECT_EQ(other.values(), model.value);
    return !taken;
  };
  CarvedBricks bad = good;
  bad.brick[0] = static_cast<std::uint32_t>(model.lattice.brickCount());
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.brick[1] = bad.brick[0];
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.brick.pop_back();
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.value[1][77] = std::nan("");
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.value[1][77] = 2.0 * model.band;
  EXPECT_TRUE(refused(bad));
  bad = good;
  bad.brick[0] = 0;  // a corner of the lattice
  bad.value[0].fill(-1e-6);
  EXPECT_TRUE(refused(bad));
}

TEST(CarvedField, ModelSaysWhatIsWrong) {
  FieldModel model = test::lump(41);
  EXPECT_EQ(model.fault(), "");
  model.value[100] = std::numeric_limits<double>::infinity();
  EXPECT_NE(model.fault().find("value 100"), std::string::npos);
  model = test::lump(41);
  model.value[model.lattice.node({40, 3, 3})] = -1e-5;
  EXPECT_NE(model.fault().find("border"), std::string::npos);
  model.value.pop_back();
  expectNames(model.fault(), {"node"});
}

TEST(CarvedField, OnlyRises) {
  const FieldModel model = test::lump(41);
  CarvedField field(model);
  CarvedBricks state;
  carveSome(field, state, 10);
  for (std::size_t n = 0; n < model.value.size(); ++n) {
    ASSERT_GE(field.values()[n], model.value[n]);
    ASSERT_LE(field.values()[n], model.band);
    ASSERT_EQ(field.values()[n] < 0.0, field.inside(static_cast<std::uint32_t>(n)));
  }
}

TEST(Fill, EveryNodeBelongsToOneHexahedron) {
  const FieldModel model = test::lump(41);
  const CarvedField field(model);
  Fill fill(model.lattice, 8);
  fill.rebuild(field);
  EXPECT_EQ(fill.size(), Index3(5, 5, 5));
  std::int64_t sum = 0;
  for (const std::int32_t n : fill.counts()) sum += n;
  EXPECT_EQ(sum, test::insideNodes(field));
  std::int64_t nodes = 0;
  Index3 h;
  for (h[2] = 0; h[2] < 5; ++h[2]) {
    for (h[1] = 0; h[1] < 5; ++h[1]) {
      for (h[0] = 0; h[0] < 5; ++h[0]) {
        const Index3 size = fill.upper(h) - fill.lower(h);
        nodes += size.prod();
        EXPECT_EQ(fill.hexahedronOfNode(fill.lower(h)), h);
        EXPECT_EQ(fill.hexahedronOfNode(fill.upper(h) - Index3::Ones()), h);
      }
    }
  }
  EXPECT_EQ(nodes, 41 * 41 * 41);
}

}  // namespace
}  // namespace calot
