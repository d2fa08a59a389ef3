// SPDX-License-Identifier: GPL-3.0-or-later
// An operation made by hand: a scene with everything, and steps that say what a test wants them to.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/analytics/checkpoints/support/steps.h"
#include "tests/support/message.h"

namespace calot::analytics::support {

/// Structures of the operation, as `touching` and subjects of events count them.
enum Structure : std::uint16_t {
  liver = 0,
  gallbladder = 1,
  bileDuct = 2,
  cysticDuct = 3,
  hepaticArtery = 4,
  cysticArtery = 5,
  fat = 6
};

/// Names and looks say nothing: what a tissue is follows from its role.
inline SceneDescription operationScene() {
  SceneDescription s = scene();
  s.organs[0].name = "organ-a";
  s.organs[1].name = "organ-b";
  s.organs[1].burnThrough = 1.0;
  for (OrganDescription& organ : s.organs) organ.appearance = "tissue";
  const auto vessel = [&](const char* name, StructureRole role) {
    VesselDescription& v = s.vessels.emplace_back();
    v.name = name;
    v.role = role;
    v.start.kind = VesselEndDescription::Kind::fixed;
  };
  vessel("v1", StructureRole::bileDuct);
  vessel("v2", StructureRole::cysticDuct);
  vessel("v3", StructureRole::artery);
  vessel("v4", StructureRole::cysticArtery);
  FatDescription& f = s.fat.emplace_back();
  f.name = "fat";
  f.role = StructureRole::triangleFat;
  f.triangleDepth = 0.01;
  s.procedure.specimen = "organ-b";
  ConnectiveDescription& bed = s.connective.emplace_back();
  bed.name = "bed";
  bed.role = StructureRole::cysticPlate;
  bed.first = "organ-b";
  bed.second = "organ-a";
  return s;
}

inline recorder::AttemptHeader operationHeader() {
  recorder::AttemptHeader h = header();
  h.organs = {"organ-a", "organ-b"};
  h.vessels = {"v1", "v2", "v3", "v4"};
  h.fat = {"fat"};
  h.layout.components = {"clock"};
  return h;
}

/// Begins whole: 8 ml of fat, 2 of them to be cleared, the bed attached. `finish` changes what stays changed.
class Operation {
 public:
  explicit Operation(const SceneDescription& scene = operationScene(),
                     const recorder::AttemptHeader& header = operationHeader(), Origin origin = Origin::resimulated)
      : collector(header, scene, origin) {
    now.organ.resize(2);
    now.vessel.resize(4);
    now.fat.resize(1);
    now.fat[0].volume = 8e-6;
    now.fat[0].toClear = 2e-6;
    now.connective.resize(1);
    now.connective[0].attached = 1.0;
    for (HandResult& hand : now.hand) hand.instrument = InstrumentKind::grasper;
  }

  /// One step as `now` is, judged as `judged` is; events are of this step alone.
  void step() { steps(1); }
  void steps(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) step(std::vector<TickSamples>(10));
  }
  /// The same with these samples of hands and camera.
  void step(const std::vector<TickSamples>& samples) {
    const std::vector<recorder::TickOutcome> ticks(samples.size());
    const StateDigest digest;
    now.step = next;
    judged.events = now.events;
    collector.take({next, samples, ticks, now, digest, 0.0F, {}, {}}, judged);
    ++next;
    now.events.clear();
  }
  void tell(EventKind kind, std::uint8_t hand, std::uint16_t subject, double value = 0.0) {
    now.events.push_back({next, kind, hand, subject, Vec3::Zero(), value});
  }
  void end(recorder::Outcome outcome = recorder::Outcome::completed) { collector.onEnd(outcome); }
  [[nodiscard]] CheckpointValue value(const std::string& name, const std::string& subject = "") const {
    return valueOf(collector, name, subject);
  }
  [[nodiscard]] bool has(const std::string& name, const std::string& subject) const {
    const std::vector<CheckpointValue> values = collector.values();
    return std::any_of(values.begin(), values.end(),
                       [&](const CheckpointValue& v) { return v.name == name && v.subject == subject; });
  }

  CheckpointCollector collector;
  StepResult now;
  Judgement judged;
  std::uint64_t next = 0;
};

inline void expectNotApplicable(const CheckpointValue& v, const std::vector<std::string>& values) {
  EXPECT_EQ(v.availability, Availability::notApplicable) << v.name;
  EXPECT_FALSE(v.value) << v.name;
  expectNames(v.reason, values);
}

inline void expectNotAvailable(const CheckpointValue& v, const std::vector<std::string>& values) {
  EXPECT_EQ(v.availability, Availability::notAvailable) << v.name;
  EXPECT_FALSE(v.value) << v.name;
  expectNames(v.reason, values);
}

}  // namespace calot::analytics::support
