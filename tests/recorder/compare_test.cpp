// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/verification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "sim/scene/version.h"

namespace calot::recorder {
namespace {

AttemptHeader headerOf(std::uint32_t version) {
  AttemptHeader h;
  h.stepResultVersion = version;
  h.organs = {"liver", "gallbladder"};
  if (version >= 3) {
    h.vessels = {"duct"};
    h.fat = {"fat"};
  }
  h.layout.components = {"clock", "connective.bed"};
  return h;
}

StepResult resultOf(const AttemptHeader& header) {
  StepResult r;
  r.step = 7;
  for (HandResult& hand : r.hand) hand.structureForce.assign(header.structures().size(), 0.5);
  r.organ.resize(header.organs.size());
  r.connective.resize(1);
  r.vessel.resize(header.vessels.size());
  r.fat.resize(header.fat.size());
  r.events.resize(2);
  return r;
}

TEST(ResultComparison, SeesEveryChangeAndNamesIt) {
  const AttemptHeader header = headerOf(stepResultVersion);
  const StepResult recorded = resultOf(header);
  ResultComparison compare(header);
  EXPECT_FALSE(compare(recorded, recorded));
  const double ulp = std::numeric_limits<double>::epsilon();
  const struct {
    const char* field;
    std::function<void(StepResult&)> change;
  } cases[] = {
      {"left/instrument", [](StepResult& r) { r.hand[0].instrument = InstrumentKind::hook; }},
      {"right/tip_real[2]", [](StepResult& r) { r.hand[1].tipReal[2] = -0.0; }},
      {"right/orientation[0]", [&](StepResult& r) { r.hand[1].orientation.w() -= ulp; }},
      {"right/orientation[3]", [](StepResult& r) { r.hand[1].orientation.z() = 1e-300; }},
      {"left/contact_torque", [](StepResult& r) { r.hand[0].contactTorque = std::nan(""); }},
      {"right/touching", [](StepResult& r) { r.hand[1].touching = 8; }},
      {"left/grasping", [](StepResult& r) { r.hand[0].grasping = 1U << 31U; }},
      {"left/organ_force[3]", [](StepResult& r) { r.hand[0].structureForce[3] = 0.25; }},
      {"left/organ_force.size", [](StepResult& r) { r.hand[0].structureForce.pop_back(); }},
      {"left/cautery", [](StepResult& r) { r.hand[0].cautery = Cautery::onTissue; }},
      {"right/clips", [](StepResult& r) { r.hand[1].clips = 3; }},
      {"organs/asleep[1]", [](StepResult& r) { r.organ[1].asleep = true; }},
      {"organs/charred_area[0]", [](StepResult& r) { r.organ[0].charredArea = 1e-9; }},
      {"organs/volume.size", [](StepResult& r) { r.organ.resize(3); }},
      {"connective/hook_touches[0]", [](StepResult& r) { r.connective[0].hookTouches = 1; }},
      {"vessels/partings[0]", [](StepResult& r) { r.vessel[0].partings = 1; }},
      {"vessels/largest_strain.size", [](StepResult& r) { r.vessel.clear(); }},
      {"fat/islands[0]", [](StepResult& r) { r.fat[0].islands = 1e-12; }},
      {"fat/uncleared[0]", [](StepResult& r) { r.fat[0].uncleared = 0.5; }},
      {"fat/holds_specimen[0]", [](StepResult& r) { r.fat[0].holdsSpecimen = true; }},
      {"contact/tissue_depth", [](StepResult& r) { r.contact.tissueDepth = 1e-6; }},
      {"contact/instruments_touch", [](StepResult& r) { r.contact.instrumentsTouch = true; }},
      {"misses", [](StepResult& r) { r.misses = miss::contact; }},
  };
  for (const auto& c : cases) {
    StepResult here = recorded;
    c.change(here);
    const auto d = compare(recorded, here);
    ASSERT_TRUE(d) << c.field;
    EXPECT_EQ(d->component, "observables");
    EXPECT_EQ(d->field, c.field);
    EXPECT_EQ(d->step, 7U);
    EXPECT_EQ(compare(here, recorded)->field, c.field);
    EXPECT_FALSE(compare(here, here)) << c.field << ": also a NaN is itself";
  }
}

TEST(ResultComparison, TellsBothValuesOfAnEventsField) {
  const AttemptHeader header = headerOf(stepResultVersion);
  const StepResult recorded = resultOf(header);
  ResultComparison compare(header);
  StepResult here = recorded;
  here.events[1].position[1] = 0.25;
  auto d = compare(recorded, here);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->component, "events");
  EXPECT_EQ(d->field, "[1]/position[1]");
  EXPECT_EQ(d->detail, "recorded 0, here 0.25");
  here = recorded;
  here.events[0].kind = EventKind::vesselCut;
  d = compare(recorded, here);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->field, "[0]/kind");
  EXPECT_EQ(d->detail, "recorded 1, here 26");
  here.events.pop_back();
  d = compare(recorded, here);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->field, "count");
}

/// What a recording of an earlier version does not tell cannot differ; what it tells of organs is compared.
TEST(ResultComparison, GoesByTheRecordingsVersion) {
  const AttemptHeader earlier = headerOf(2);
  const StepResult recorded = resultOf(earlier);
  StepResult here = resultOf(headerOf(3));
  here.hand[0].clips = 8;
  here.organ[1].charredArea = 1.0;
  here.vessel[0].clips = 2;
  here.hand[1].structureForce[3] = 9.0;
  ResultComparison compare(earlier);
  EXPECT_FALSE(compare(recorded, here));
  here.hand[1].structureForce[1] = 9.0;
  const auto d = compare(recorded, here);
  ASSERT_TRUE(d);
  EXPECT_EQ(d->field, "right/organ_force[1]");
}

/// The judgement that version 3 of StepResult held, as an engine of that version gives it again.
TEST(ProcedureComparison, NamesTheFirstFieldThatDiffers) {
  using Change = void (*)(RecordedProcedure&);
  const RecordedProcedure recorded{Phase::identification, 1, 2, 1, true, 0.25, 3, 1};
  EXPECT_FALSE(compareProcedure(7, recorded, recorded));
  const struct {
    const char *field, *detail;
    Change change;
  } cases[] = {
      {"phase", "recorded 1, here 0", [](RecordedProcedure& p) { p.phase = Phase::none; }},
      {"triangle_cleared", "recorded 1, here 2", [](RecordedProcedure& p) { p.triangleCleared = 2; }},
      {"lower_third_freed", "recorded 2, here 0", [](RecordedProcedure& p) { p.lowerThirdFreed = 0; }},
      {"two_structures", "recorded 1, here 2", [](RecordedProcedure& p) { p.twoStructures = 2; }},
      {"critical_view_frozen", "recorded 1, here 0", [](RecordedProcedure& p) { p.criticalViewFrozen = false; }},
      {"lower_third_attached", "recorded 0.25, here 0.5", [](RecordedProcedure& p) { p.lowerThirdAttached = 0.5; }},
      {"errors", "recorded 3, here 4", [](RecordedProcedure& p) { p.errors = 4; }},
      {"critical_errors", "recorded 1, here 0", [](RecordedProcedure& p) { p.criticalErrors = 0; }},
  };
  for (const auto& c : cases) {
    RecordedProcedure here = recorded;
    c.change(here);
    const auto d = compareProcedure(7, recorded, here);
    ASSERT_TRUE(d) << c.field;
    EXPECT_EQ(d->step, 7U);
    EXPECT_EQ(d->component, "observables");
    EXPECT_EQ(d->field, std::string("procedure/") + c.field);
    EXPECT_EQ(d->detail, c.detail);
  }
}

}  // namespace
}  // namespace calot::recorder
