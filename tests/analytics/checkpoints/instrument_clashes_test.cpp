// SPDX-License-Identifier: GPL-3.0-or-later
// How often and how long the instruments touched each other.
#include <gtest/gtest.h>

#include "tests/analytics/checkpoints/support/operation.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using namespace support;

recorder::AttemptHeader tellingHeader(std::uint32_t version) {
  recorder::AttemptHeader h = operationHeader();
  h.stepResultVersion = version;
  return h;
}

TEST(InstrumentClashes, AreCountedAndTimed) {
  Operation o(operationScene(), tellingHeader(6));
  for (int i = 0; i < 12; ++i) {
    o.now.contact.instrumentsTouch = i % 4 != 0;
    o.now.events.clear();
    if (i == 1 || i == 9) o.now.events.push_back({0, EventKind::instrumentsTouched, 255, 0, Vec3::Zero(), 0.5});
    o.step();
  }
  o.end();
  EXPECT_DOUBLE_EQ(*o.value("instrument-clashes").value, 2.0) << "what the step calls one touch is one";
  EXPECT_NEAR(*o.value("instrument-clash-time").value, 0.09, 1e-12);
}

TEST(InstrumentClashes, AreNotKnownOfResultsThatDoNotTellOfThem) {
  Operation o(operationScene(), tellingHeader(5));
  o.step();
  o.end();
  for (const char* name : {"instrument-clashes", "instrument-clash-time"})
    expectNames(o.value(name).reason, {"version 5"});
}

TEST(InstrumentClashes, NeedTwoInstruments) {
  Operation o(operationScene(), tellingHeader(6));
  o.now.hand[0].instrument = InstrumentKind::none;
  o.step();
  o.end();
  EXPECT_EQ(o.value("instrument-clashes").availability, Availability::notApplicable);
  expectNames(o.value("instrument-clashes").reason, {"instruments"});
}

}  // namespace
}  // namespace calot::analytics
