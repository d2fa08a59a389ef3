// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/instruments/instruments.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "sim/instruments/instrument_shape.h"

namespace calot {
namespace {

/// Recordings and scene files hold these for good.
TEST(Instruments, KeepTheirNumbersAndNames) {
  const std::pair<unsigned, const char*> stored[] = {{1, "grasper"}, {2, "hook"}, {3, "clip-applier"}, {4, "scissors"}};
  for (const auto& [number, name] : stored) {
    ASSERT_TRUE(isInstrumentNumber(number));
    EXPECT_STREQ(instrumentOf(static_cast<InstrumentKind>(number)).name, name);
  }
  EXPECT_EQ(static_cast<unsigned>(InstrumentKind::none), 0U);
}

TEST(Instruments, EveryRowIsComplete) {
  std::set<unsigned> numbers;
  std::set<std::string> names, words;
  for (const InstrumentDefinition* each : instruments()) {
    SCOPED_TRACE(each->name);
    const auto number = static_cast<unsigned>(each->kind);
    EXPECT_NE(each->kind, InstrumentKind::none);
    EXPECT_TRUE(numbers.insert(number).second);
    EXPECT_TRUE(isInstrumentNumber(number));
    EXPECT_EQ(&instrumentOf(each->kind), each);
    EXPECT_TRUE(names.insert(each->name).second);
    EXPECT_EQ(findInstrument(each->name), each);
    EXPECT_EQ(std::string(each->name).find_first_not_of("abcdefghijklmnopqrstuvwxyz-"), std::string::npos);
    EXPECT_TRUE(words.insert(each->word).second);
    EXPECT_FALSE(std::string(each->word).empty());
    EXPECT_EQ(each->action == InstrumentAction::none, each->kind == InstrumentKind::probe) << "a probe only touches";
    EXPECT_GT(each->jaw.opened, each->jaw.closed);
    EXPECT_GT(each->jaw.closed, 0.0);
    EXPECT_FALSE(instrumentShape(each->kind, 0.4, 0.0025, 0.15).capsules().empty());
  }
  EXPECT_EQ(findInstrument("none"), nullptr) << "a scene mounts something on each hand";
  EXPECT_EQ(findInstrument("spoon"), nullptr);
}

/// What an action needs of its instrument is there.
TEST(Instruments, HaveWhatTheirActionNeeds) {
  for (const InstrumentDefinition* each : instruments()) {
    SCOPED_TRACE(each->name);
    const InstrumentShape shape = instrumentShape(each->kind, 0.4, 0.0025, 0.15);
    const auto parts = [&](Capsule::Part part) {
      return std::count_if(shape.capsules().begin(), shape.capsules().end(),
                           [part](const Capsule& c) { return c.part == part; });
    };
    EXPECT_EQ(parts(Capsule::Part::upperJaw), parts(Capsule::Part::lowerJaw));
    EXPECT_EQ(parts(Capsule::Part::upperJaw) > 0, each->jawLength > 0.0);
    EXPECT_EQ(shape.jawReach() > 0.0, each->jawLength > 0.0);
    EXPECT_EQ(parts(Capsule::Part::electrode) > 0, each->action == InstrumentAction::burn);
    EXPECT_EQ(each->teethLength > 0.0, each->action == InstrumentAction::grasp);
    EXPECT_EQ(each->bladeLength > 0.0, each->action == InstrumentAction::cut);
    EXPECT_LE(std::max(each->teethLength, each->bladeLength), each->jawLength);
  }
}

TEST(Instruments, NothingAndNumbersThatNobodyHasAreNoInstrument) {
  EXPECT_TRUE(isInstrumentNumber(0));
  const unsigned last = 255;
  EXPECT_FALSE(isInstrumentNumber(last));
  EXPECT_FALSE(isInstrumentNumber(256));
  for (const InstrumentKind kind : {InstrumentKind::none, static_cast<InstrumentKind>(last)}) {
    EXPECT_EQ(instrumentOf(kind).action, InstrumentAction::none);
    EXPECT_STREQ(instrumentOf(kind).word, "nothing");
    EXPECT_TRUE(instrumentShape(kind, 0.4, 0.0025, 0.15).capsules().empty());
  }
}

/// The page for authors of scenes and readers of recordings.
TEST(Instruments, DocsAgree) {
  std::ifstream file(std::string(CALOT_SOURCE_DIR) + "/docs/reference/scenes.md");
  ASSERT_TRUE(file);
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  for (const InstrumentDefinition* each : instruments()) {
    const std::string row = "\n| " + std::to_string(static_cast<unsigned>(each->kind)) + " | `" + each->name + "` | ";
    EXPECT_NE(text.find(row), std::string::npos) << row;
  }
}

}  // namespace
}  // namespace calot
