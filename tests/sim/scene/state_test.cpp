// SPDX-License-Identifier: GPL-3.0-or-later
// Digests and bytes of a State.
#include "sim/scene/state.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "sim/scene/flat.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

/// A state with something in every field.
class StateTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    model_ = test::buildModel(test::blockAndBallScene());
    ASSERT_TRUE(model_);
    test::Rig rig(*model_);
    for (int i = 0; i < 45; ++i) {
      const test::TipPair tips = test::contactRun(i);
      rig.step(tips.left, tips.right);
    }
    state_ = std::make_unique<State>(rig.state);
    ASSERT_FALSE(state_->hand[0].touches.key.empty()) << "the run must touch";
    ASSERT_FALSE(state_->hand[1].touches.key.empty()) << "the run must touch";
  }
  static void TearDownTestSuite() {
    state_.reset();
    model_.reset();
  }
  static inline std::unique_ptr<const Model> model_;
  static inline std::unique_ptr<State> state_;
};

/// Changes one bit of the wanted field, counted over all components.
struct Flip {
  std::size_t wanted;
  std::size_t at = 0;
  std::size_t element = 0;  // of a vector; beyond its end: one more element
  std::string name;

  template <class T>
  void operator()(const char* fieldName, T& value) {
    if (at++ != wanted) return;
    name = fieldName;
    flip(value);
  }
  template <class T>
  requires isPlain<T>
  void flip(T& value) {
    auto* byte = reinterpret_cast<unsigned char*>(&value);
    *byte = static_cast<unsigned char>(*byte ^ 1U);
  }
  template <class T>
  void flip(std::vector<T>& values) {
    if (element < values.size()) {
      flip(values[element]);
    } else {
      T zero;
      std::memset(static_cast<void*>(&zero), 0, sizeof zero);
      values.push_back(zero);
    }
  }
};

TEST_F(StateTest, ChangingAFieldChangesItsDigestAndNoOther) {
  const StateDigest before = digestOf(*state_);
  const DigestLayout& layout = model_->layout();
  ASSERT_EQ(before.component.size(), layout.components.size());
  ASSERT_EQ(before.field.size(), layout.fields.size());
  for (std::size_t f = 0; f < layout.fields.size(); ++f) {
    for (const std::size_t element : {std::size_t{0}, std::size_t{1}, std::numeric_limits<std::size_t>::max()}) {
      State changed = *state_;
      Flip flip{f, 0, element, {}};
      State::components(changed, [&](auto& part) { std::remove_cvref_t<decltype(part)>::fields(part, flip); });
      ASSERT_EQ(flip.at, layout.fields.size()) << "the layout lists every field that is visited";
      EXPECT_EQ(layout.fields[f].name, layout.components[layout.fields[f].component] + "/" + flip.name);
      const StateDigest after = digestOf(changed);
      for (std::size_t g = 0; g < after.field.size(); ++g) {
        EXPECT_EQ(after.field[g] != before.field[g], g == f)
            << layout.fields[f].name << " and " << layout.fields[g].name;
      }
      for (std::size_t c = 0; c < after.component.size(); ++c) {
        EXPECT_EQ(after.component[c] != before.component[c], c == layout.fields[f].component) << layout.fields[f].name;
      }
    }
  }
}

TEST_F(StateTest, ComponentsAreNamedInOrder) {
  EXPECT_EQ(
      model_->layout().components,
      (std::vector<std::string>{"clock", "camera", "hand.left.input", "hand.left.instrument", "hand.left.touches",
                                "hand.left.grasp", "hand.left.burn", "hand.right.input", "hand.right.instrument",
                                "hand.right.touches", "hand.right.grasp", "hand.right.burn", "instruments", "tissue",
                                "retraction", "organ.block", "organ.ball", "charred.block", "charred.ball"}));
  EXPECT_EQ(model_->layout().components[state_->tissueFrom()], "organ.block");
}

TEST_F(StateTest, AChangedGraspChangesTheComponentOfGraspsAlone) {
  State changed = *state_;
  changed.hand[1].grasp.slipping = !changed.hand[1].grasp.slipping;
  const StateDigest before = digestOf(*state_);
  const StateDigest after = digestOf(changed);
  for (std::size_t c = 0; c < after.component.size(); ++c) {
    const std::string& name = model_->layout().components[c];
    EXPECT_EQ(after.component[c] != before.component[c], name == "hand.right.grasp") << name;
  }
}

/// An unwritten component keeps its digest, so a component that is written and not marked would be seen here.
TEST_F(StateTest, IncrementalDigestHashesWhatIsMarked) {
  IncrementalDigest incremental;
  State state = *state_;
  const std::vector<bool> none(model_->layout().components.size(), false);
  const StateDigest first = incremental.update(state, none);
  EXPECT_EQ(first, digestOf(state)) << "the first update hashes all, whatever is marked";
  state.organ[1].position[3][1] += 1e-9;
  EXPECT_EQ(incremental.update(state, none), first) << "nothing marked, nothing hashed";
  std::vector<bool> ball = none;
  ball[state.tissueFrom() + 1] = true;
  EXPECT_EQ(incremental.update(state, ball), digestOf(state));
  state.hand[0].instrument.jaw += 0.1;
  incremental.reset();
  EXPECT_EQ(incremental.update(state, none), digestOf(state)) << "after a reset all is hashed";
}

TEST_F(StateTest, BytesRoundTrip) {
  const std::vector<std::byte> bytes = saveState(*state_);
  State restored = initialState(*model_, 99);
  ASSERT_TRUE(restoreState(*model_, bytes, restored));
  EXPECT_EQ(saveState(restored), bytes);
  EXPECT_EQ(digestOf(restored), digestOf(*state_));
}

TEST_F(StateTest, RefusesBytesThatAreNoStateOfThisModel) {
  const std::vector<std::byte> bytes = saveState(*state_);
  const State start = initialState(*model_, 5);
  const StateDigest untouched = digestOf(start);
  const auto refuses = [&](const std::vector<std::byte>& wrong, const std::string& what) {
    State state = start;
    EXPECT_FALSE(restoreState(*model_, wrong, state)) << what;
    EXPECT_EQ(digestOf(state), untouched) << what << ": a refused restore leaves the state as it was";
  };
  refuses({}, "nothing");
  for (std::size_t size = 0; size < bytes.size(); size += size < 700 ? 1 : 977) {
    State state = start;
    ASSERT_FALSE(restoreState(*model_, std::span(bytes).first(size), state)) << size << " bytes";
  }
  refuses({bytes.begin(), bytes.end() - 1}, "one byte missing");
  std::vector<std::byte> longer = bytes;
  longer.push_back(std::byte{0});
  refuses(longer, "one byte too many");
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    State state = *state_;
    state.organ[0].position[17][2] = bad;
    refuses(saveState(state), "position");
    state = *state_;
    state.organ[1].rotation[2][3][5] = bad;
    refuses(saveState(state), "rotation");
    state = *state_;
    state.hand[1].input.orientation.x() = bad;
    refuses(saveState(state), "orientation");
    state = *state_;
    state.hand[0].touches.force[0][1] = bad;
    refuses(saveState(state), "contact force");
  }
  State state = *state_;
  state.organ[0].velocity.pop_back();
  refuses(saveState(state), "a node less");
  state = *state_;
  state.organ[0].rotation.emplace_back();
  refuses(saveState(state), "a group of elements more");
  state = *state_;
  state.hand[0].touches.since.push_back(0);
  refuses(saveState(state), "an organ more");
  state = *state_;
  state.hand[0].touches.force.emplace_back(Vec3::Zero());
  refuses(saveState(state), "a force without a place");
  state = *state_;
  state.hand[0].touches.dimple.emplace_back(Vec3::Zero());
  refuses(saveState(state), "a dimple without a place");
  state = *state_;
  state.hand[0].touches.dimpleKey.push_back(2U << 8U);
  state.hand[0].touches.dimple.emplace_back(Vec3::Zero());
  refuses(saveState(state), "a dimple of no organ");
  state = *state_;
  state.hand[0].burn.tissue = smokeOfConnective;
  refuses(saveState(state), "a burn of tissue that there is not");
  state = *state_;
  state.tissue.force.push_back(0.0);
  refuses(saveState(state), "a force among organs without a place");
  state = *state_;
  state.response.points.push_back(1);
  refuses(saveState(state), "a response without a place");
  state = *state_;
  state.hand[1].grasp.structure = 0;
  refuses(saveState(state), "a hold of nothing");
  state = *state_;
  const auto hold = [&](std::uint32_t organ, std::uint32_t corner) {
    state = *state_;
    GraspState& grasp = state.hand[1].grasp;
    grasp.structure = organ;
    grasp.node = {{0, 1, corner}};
    grasp.weight = {Vec3(0.2, 0.3, 0.5)};
    grasp.place = {Vec3::Zero()};
    grasp.force = {Vec3::Zero()};
  };
  const auto corners = static_cast<std::uint32_t>(model_->organs()[0].skin.size());
  hold(0, corners - 1);
  State taken = start;
  EXPECT_TRUE(restoreState(*model_, saveState(state), taken)) << "the last corner there is";
  hold(0, corners);
  refuses(saveState(state), "a held corner that the organ does not have");
  hold(2, 0);
  refuses(saveState(state), "a held organ that there is not");
  hold(noStructure, 0);
  refuses(saveState(state), "a held place of no organ");
  hold(0, 0);
  state.hand[1].grasp.force.clear();
  refuses(saveState(state), "a held place without a force");
  state = *state_;
  state.organ.pop_back();
  refuses(saveState(state), "an organ less");
  const std::unique_ptr<const Model> other = test::buildModel(test::blockScene(300));
  ASSERT_TRUE(other);
  refuses(saveState(initialState(*other, 1)), "another model");
}

/// A length that claims more than there is must not be believed, least of all allocated.
TEST_F(StateTest, HugeLengthsAreRefused) {
  std::vector<std::byte> bytes = saveState(*state_);
  const std::uint64_t size = state_->organ[0].position.size();
  bool found = false;
  for (std::size_t at = 0; at + 8 <= bytes.size() && !found; ++at) {
    std::uint64_t value = 0;
    std::memcpy(&value, bytes.data() + at, 8);
    if (value != size) continue;
    found = true;
    for (const std::uint64_t claim : {std::uint64_t{1} << 40U, ~std::uint64_t{0}, (~std::uint64_t{0} / 24) + 2}) {
      std::memcpy(bytes.data() + at, &claim, 8);
      State state = initialState(*model_, 5);
      EXPECT_FALSE(restoreState(*model_, bytes, state)) << claim;
    }
  }
  EXPECT_TRUE(found);
}

TEST_F(StateTest, FlatStateRoundTrips) {
  FlatState flat;
  flat.scene = model_->scene();
  flat.state = saveState(*state_);
  for (int i = 45; i < 48; ++i) {
    const test::TipPair tips = test::contactRun(i);
    const std::vector<TickSamples> ticks = test::ticksAt(flat.scene, tips.left, tips.right);
    flat.ticks.insert(flat.ticks.end(), ticks.begin(), ticks.end());
  }
  flat.ticks[4].hand[1].valid = false;
  flat.ticks[5].hand[0].buttons = button::fire;
  const std::vector<std::byte> bytes = saveFlat(flat);
  FlatState read;
  ASSERT_TRUE(loadFlat(bytes, read));
  EXPECT_EQ(saveFlat(read), bytes);
  EXPECT_EQ(read.state, flat.state);
  ASSERT_EQ(read.ticks.size(), flat.ticks.size());
  EXPECT_FALSE(read.ticks[4].hand[1].valid);
  EXPECT_EQ(read.ticks[5].hand[0].buttons, button::fire);
  // A model of the read scene takes the state and goes the same way.
  const std::unique_ptr<const Model> again = test::buildModel(read.scene);
  ASSERT_TRUE(again);
  State a = *state_;
  State b;
  ASSERT_TRUE(restoreState(*again, read.state, b));
  SerialExecutor executor;
  Stepper original(*model_, executor);
  Stepper copy(*again, executor);
  for (std::size_t at = 0; at < flat.ticks.size(); at += flat.scene.ticksPerStep) {
    original.step(a, std::span(flat.ticks).subspan(at, flat.scene.ticksPerStep));
    copy.step(b, std::span(read.ticks).subspan(at, flat.scene.ticksPerStep));
    EXPECT_EQ(digestOf(a), digestOf(b));
  }
  for (std::size_t size = 0; size < bytes.size(); size += size < 300 ? 1 : 2003) {
    FlatState cut;
    ASSERT_FALSE(loadFlat(std::span(bytes).first(size), cut)) << size << " bytes";
  }
  std::vector<std::byte> wrong = bytes;
  wrong[3] = std::byte{'X'};
  EXPECT_FALSE(loadFlat(wrong, read)) << "other magic";
  wrong = bytes;
  wrong.push_back(std::byte{0});
  EXPECT_FALSE(loadFlat(wrong, read)) << "a byte too many";
}

}  // namespace
}  // namespace calot
