// SPDX-License-Identifier: GPL-3.0-or-later
// The columns of a recording, listed once (schemas/recording.md): data sets, writer, reader, recovery, export chain
// and comparison all run over this list. Internal to the recorder.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "recorder/identity.h"
#include "recorder/observer.h"

namespace calot::recorder {

inline constexpr std::uint32_t formatVersion = 1;
inline constexpr const char* formatName = "calot-recording";
inline constexpr std::uint32_t largestTicksPerStep = 1000;
inline constexpr std::uint64_t keyframeChunkWords = 8192;
inline constexpr std::uint64_t rawChunkRows = 64;
inline constexpr const char* rawCountsPath = "/device/counts";
inline constexpr const char* signaturePath = "/signature/value";
inline constexpr const char* publicKeyPath = "/signature/public_key";

/// Stored types, all little-endian. The last five are packed compounds.
enum class Element : std::uint8_t { u1, u2, u4, u8, i8, f4, f8, event, keyframe, status, rawSample, rawCounts };

/// Which count of /status, or of /device/counts beside it, a data set's rows follow.
enum class Stream : std::uint8_t { ticks, steps, events, keyframes, keyframeWords, rawLeft, rawRight };
inline constexpr std::size_t streamCount = 7;

std::size_t elementBytes(Element element);

struct Column {
  std::string path;
  Element element = Element::f8;
  Stream stream = Stream::ticks;
  bool vector = false;      ///< shape (N, width) rather than (N)
  std::uint64_t width = 1;  ///< elements a row; 0: the data set is absent
  std::uint64_t chunkRows = 1;
  bool deflate = true;  ///< shuffle and deflate below the checksum
  bool chained = true;  ///< part of the content chain
  std::string unit;     ///< of the exported values; empty: none

  [[nodiscard]] std::size_t rowBytes() const { return elementBytes(element) * static_cast<std::size_t>(width); }
};

/// Packed rows of the compound data sets.
inline constexpr std::size_t eventBytes = 45;
inline constexpr std::size_t keyframeBytes = 32;
inline constexpr std::size_t statusBytes = 82;
inline constexpr std::size_t rawSampleBytes = 99;
inline constexpr std::size_t rawCountsBytes = 32;

/// A golden recording: a digest in the place of forces; no observables, keyframes, fields' digests.
inline bool isLean(const AttemptHeader& header) { return header.purpose == "golden"; }

struct Layout {
  /// In the order of the chain: ticks, steps, events, keyframe index, keyframe bytes. Then raw samples, left and right.
  std::vector<Column> columns;
  std::size_t tickColumns = 0;                                   ///< the first ones
  std::size_t stepColumns = 0;                                   ///< the next ones
  std::size_t events = 0, keyframeIndex = 0, keyframeWords = 0;  ///< places of the others
  std::array<std::size_t, handCount> raw{};
  bool deviceSamples = false;  ///< there is a /device
  bool lean = false;           ///< isLean()
  std::uint32_t ticksPerStep = 10;
  std::uint64_t stepsPerBlock = 25;  ///< max(1, 250 / ticksPerStep)
  std::uint64_t ticksPerBlock = 250;
  std::uint64_t keyframeInterval = 100;  ///< steps: about a second, whole blocks
  std::uint64_t shortInterval = 25;      ///< about a quarter of it, whole blocks
  std::size_t organs = 0, tissues = 0, components = 0, fields = 0;
  std::size_t vessels = 0, fat = 0;  ///< 0 before version 3 of StepResult
  std::size_t structures = 0;        ///< organs, vessels and fat
  bool procedure = false;            ///< the scene has one
  std::uint32_t resultVersion = 1;   ///< of StepResult: which columns there are

  explicit Layout(const AttemptHeader& header);

  /// How many there are of what a step tells something of.
  [[nodiscard]] std::size_t countOf(const std::vector<OrganResult>&) const { return organs; }
  [[nodiscard]] std::size_t countOf(const std::vector<ConnectiveResult>&) const { return tissues; }
  [[nodiscard]] std::size_t countOf(const std::vector<VesselResult>&) const { return vessels; }
  [[nodiscard]] std::size_t countOf(const std::vector<FatResult>&) const { return fat; }
};

/// Names of the scene's connective tissues, as the State's components say.
std::vector<std::string> connectiveNames(const AttemptHeader& header);

/// Whether the scene has a procedure, as the State's components say.
bool hasProcedure(const AttemptHeader& header);

/// Whether steps tell of vessels, fat and procedure: from version 3 of StepResult on.
inline bool tellsOfStructures(std::uint32_t stepResultVersion) { return stepResultVersion >= 3; }

/// Lists what one tick stores. A visitor is called with (folder, name, unit, value); `outside` is for what the chain
/// leaves out.
template <class Samples, class Outcome, class Visitor>
void visitTick(Samples& s, Outcome& o, Visitor& visit) {
  static constexpr std::array<const char*, handCount> folder{"/ticks/left", "/ticks/right"};
  for (std::size_t h = 0; h < folder.size(); ++h) {
    visit(folder[h], "position", "m", s.hand[h].position);
    visit(folder[h], "orientation", "", s.hand[h].orientation);
    visit(folder[h], "instrument", "", s.hand[h].instrument);
    visit(folder[h], "jaw", "rad", s.hand[h].jaw);
    visit(folder[h], "buttons", "", s.hand[h].buttons);
    visit(folder[h], "valid", "", s.hand[h].valid);
    visit(folder[h], "contact_set", "", o.hand[h].contactSet);
    if (visit.layout.lean) continue;
    visit(folder[h], "force", "N", o.hand[h].force);
    visit(folder[h], "torque", "N m", o.hand[h].torque);
  }
  visit("/camera", "position", "m", s.camera.position);
  visit("/camera", "orientation", "", s.camera.orientation);
  visit.outside("/ticks", "lateness", "s", o.lateness);
}

template <class Result, class Visitor>
void visitConnective(Result& r, Visitor& visit) {
  static constexpr const char* connective = "/observables/connective";
  visit.each(connective, "attached", "", r.connective, &ConnectiveResult::attached);
  visit.each(connective, "burned", "", r.connective, &ConnectiveResult::burned);
  visit.each(connective, "torn", "", r.connective, &ConnectiveResult::torn);
  visit.each(connective, "largest_pull", "Pa", r.connective, &ConnectiveResult::largestPull);
  visit.each(connective, "hook_touches", "", r.connective, &ConnectiveResult::hookTouches);
}

template <class Result, class Visitor>
void visitVessels(Result& r, Visitor& visit) {
  static constexpr const char* vessels = "/observables/vessels";
  visit.each(vessels, "largest_strain", "", r.vessel, &VesselResult::largestStrain);
  visit.each(vessels, "largest_tension", "N", r.vessel, &VesselResult::largestTension);
  visit.each(vessels, "largest_displacement", "m", r.vessel, &VesselResult::largestDisplacement);
  visit.each(vessels, "clips", "", r.vessel, &VesselResult::clips);
  visit.each(vessels, "partings", "", r.vessel, &VesselResult::partings);
  visit.each(vessels, "charred", "", r.vessel, &VesselResult::charred);
  visit.each(vessels, "asleep", "", r.vessel, &VesselResult::asleep);
}

template <class Result, class Visitor>
void visitFat(Result& r, Visitor& visit) {
  static constexpr const char* fat = "/observables/fat";
  visit.each(fat, "volume", "m^3", r.fat, &FatResult::volume);
  visit.each(fat, "to_clear", "m^3", r.fat, &FatResult::toClear);
  visit.each(fat, "carved", "m^3", r.fat, &FatResult::carved);
  visit.each(fat, "islands", "m^3", r.fat, &FatResult::islands);
  visit.each(fat, "largest_displacement", "m", r.fat, &FatResult::largestDisplacement);
  visit.each(fat, "largest_speed", "m/s", r.fat, &FatResult::largestSpeed);
  visit.each(fat, "residual", "", r.fat, &FatResult::residual);
  visit.each(fat, "iterations", "", r.fat, &FatResult::iterations);
  visit.each(fat, "asleep", "", r.fat, &FatResult::asleep);
}

template <class Result, class Visitor>
void visitProcedure(Result& r, Visitor& visit) {
  static constexpr const char* procedure = "/observables/procedure";
  visit(procedure, "phase", "", r.procedure.phase);
  visit(procedure, "triangle_cleared", "", r.procedure.triangleCleared);
  visit(procedure, "lower_third_freed", "", r.procedure.lowerThirdFreed);
  visit(procedure, "two_structures", "", r.procedure.twoStructures);
  visit(procedure, "critical_view_frozen", "", r.procedure.criticalViewFrozen);
  visit(procedure, "lower_third_attached", "", r.procedure.lowerThirdAttached);
  visit(procedure, "errors", "", r.procedure.errors);
  visit(procedure, "critical_errors", "", r.procedure.criticalErrors);
}

/// Lists what a StepResult stores, but for its events.
template <class Result, class Visitor>
void visitResult(Result& r, Visitor& visit) {
  if (visit.layout.lean) return;
  static constexpr std::array<const char*, handCount> folder{"/observables/left", "/observables/right"};
  for (std::size_t h = 0; h < folder.size(); ++h) {
    visit(folder[h], "instrument", "", r.hand[h].instrument);
    visit(folder[h], "tip_real", "m", r.hand[h].tipReal);
    visit(folder[h], "tip_simulated", "m", r.hand[h].tipSimulated);
    visit(folder[h], "orientation", "", r.hand[h].orientation);
    visit(folder[h], "jaw", "rad", r.hand[h].jaw);
    visit(folder[h], "insertion", "m", r.hand[h].insertion);
    visit(folder[h], "contact_force", "N", r.hand[h].contactForce);
    visit(folder[h], "touching", "", r.hand[h].touching);
    visit.list(folder[h], "organ_force", "N", r.hand[h].structureForce, visit.layout.structures);
  }
  static constexpr const char* organs = "/observables/organs";
  visit.each(organs, "volume", "m^3", r.organ, &OrganResult::volume);
  visit.each(organs, "largest_displacement", "m", r.organ, &OrganResult::largestDisplacement);
  visit.each(organs, "largest_speed", "m/s", r.organ, &OrganResult::largestSpeed);
  visit.each(organs, "residual", "", r.organ, &OrganResult::residual);
  visit.each(organs, "iterations", "", r.organ, &OrganResult::iterations);
  visit.each(organs, "asleep", "", r.organ, &OrganResult::asleep);
  static constexpr const char* contact = "/observables/contact";
  visit(contact, "rows", "", r.contact.rows);
  visit(contact, "iterations", "", r.contact.iterations);
  visit(contact, "residual", "m", r.contact.residual);
  visit(contact, "largest_depth", "m", r.contact.largestDepth);
  visit("/observables", "misses", "", r.misses);
  if (visit.layout.resultVersion < 2) return;
  for (std::size_t h = 0; h < folder.size(); ++h) {
    visit(folder[h], "contact_torque", "N m", r.hand[h].contactTorque);
    visit(folder[h], "grasping", "", r.hand[h].grasping);
    visit(folder[h], "grasp_force", "N", r.hand[h].graspForce);
  }
  visit(contact, "blocks", "", r.contact.blocks);
  visit(contact, "newton_steps", "", r.contact.newtonSteps);
  visit(contact, "passes", "", r.contact.passes);
  visit(contact, "error", "m", r.contact.error);
  visit(contact, "violation", "m", r.contact.violation);
  visit(contact, "pinched_depth", "m", r.contact.pinchedDepth);
  visit(contact, "tissue_depth", "m", r.contact.tissueDepth);
  if (visit.layout.tissues > 0) visitConnective(r, visit);
  if (!tellsOfStructures(visit.layout.resultVersion)) return;
  for (std::size_t h = 0; h < folder.size(); ++h) {
    visit(folder[h], "cautery", "", r.hand[h].cautery);
    visit(folder[h], "clips", "", r.hand[h].clips);
  }
  visit.each(organs, "charred_area", "m^2", r.organ, &OrganResult::charredArea);
  if (visit.layout.vessels > 0) visitVessels(r, visit);
  if (visit.layout.fat > 0) visitFat(r, visit);
  if (visit.layout.procedure) visitProcedure(r, visit);
}

/// XXH3-64 of a step's forces and torques: tick by tick, left hand first.
std::uint64_t forceDigest(std::span<const TickOutcome> ticks);

/// Lists what one step stores, but for its events. @param forces digest of its ticks' forces
template <class Digest, class Forces, class Lateness, class Result, class Visitor>
void visitStep(Digest& digest, Forces& forces, Lateness& lateness, Result& r, Visitor& visit) {
  visit.list("/steps", "component_digest", "", digest.component, visit.layout.components);
  if (visit.layout.lean) {
    visit("/steps", "force_digest", "", forces);
  } else {
    visit.list("/steps", "field_digest", "", digest.field, visit.layout.fields);
  }
  visit.outside("/steps", "lateness", "s", lateness);
  visitResult(r, visit);
}

}  // namespace calot::recorder
