// SPDX-License-Identifier: GPL-3.0-or-later
// The columns of a recording, listed once (schemas/recording.md): data sets, writer, reader, recovery, export chain
// and comparison all run over this list. Internal to the recorder.
// So are the root attributes: written, read, hashed and exported by the same list.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/engine/engine.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/reader.h"
#include "sim/instruments/instruments.h"
#include "sim/tissue/tissues.h"

namespace calot::recorder {

inline constexpr const char* formatName = "calot-recording";
inline constexpr std::uint32_t maxTicksPerStep = 1000;
inline constexpr std::uint64_t keyframeChunkWords = 8192;
/// A chunk that is written more than once lies in one page of 4,096 bytes: a kill in the middle of a write spares it.
inline constexpr std::uint64_t rawChunkRows = 40;
inline constexpr const char* rawCountsPath = "/device/counts";
inline constexpr const char* signaturePath = "/signature/value";
inline constexpr const char* publicKeyPath = "/signature/public_key";

/// Stored types, all little-endian. The last five are packed compounds.
enum class Element : std::uint8_t { u1, u2, u4, u8, i8, f4, f8, event, keyframe, status, rawSample, rawCounts };

/// The count of /status, or of /device/counts beside it, that a data set's rows follow.
enum class Stream : std::uint8_t { ticks, steps, events, keyframes, keyframeWords, rawLeft, rawRight };
inline constexpr std::size_t streamCount = 7;

/// Packed rows of the compound data sets (bytes).
inline constexpr std::size_t eventBytes = 45;
inline constexpr std::size_t keyframeBytes = 32;
inline constexpr std::size_t statusBytes = 82;
inline constexpr std::size_t rawSampleBytes = 99;
inline constexpr std::size_t rawCountsBytes = 32;

inline constexpr std::size_t elementBytes(Element element) {
  constexpr std::array<std::size_t, 12> bytes{
      1, 2, 4, 8, 8, 4, 8, eventBytes, keyframeBytes, statusBytes, rawSampleBytes, rawCountsBytes};
  return bytes[static_cast<std::size_t>(element)];
}
/// "u1" to "f8", as NumPy and the engines' protocol name them. @pre the element is a number
inline constexpr const char* numberType(Element element) {
  constexpr std::array<const char*, 7> names{"u1", "u2", "u4", "u8", "i8", "f4", "f8"};
  return names[static_cast<std::size_t>(element)];
}
/// Stored type of a number, flag or choice.
template <class T>
constexpr Element storedAs() {
  constexpr bool isSigned = std::is_signed_v<T> && !std::is_enum_v<T>;
  if (std::is_floating_point_v<T>) return sizeof(T) == 4 ? Element::f4 : Element::f8;
  static_assert(!isSigned || std::is_floating_point_v<T> || sizeof(T) == 8);
  if (isSigned) return Element::i8;
  return sizeof(T) == 1 ? Element::u1 : sizeof(T) == 2 ? Element::u2 : sizeof(T) == 4 ? Element::u4 : Element::u8;
}

/// Calls use(number) with a stored number.
void withNumber(Element element, const std::byte* at, auto use) {
  const auto as = [&]<class T>(T number) {
    std::memcpy(&number, at, sizeof number);
    use(number);
  };
  switch (element) {
    case Element::u1:
      return as(std::uint8_t{});
    case Element::u2:
      return as(std::uint16_t{});
    case Element::u4:
      return as(std::uint32_t{});
    case Element::u8:
      return as(std::uint64_t{});
    case Element::i8:
      return as(std::int64_t{});
    case Element::f4:
      return as(float{});
    default:
      return as(double{});
  }
}

struct Column {
  std::string path;
  Element element = Element::f8;
  Stream stream = Stream::ticks;
  bool vector = false;      ///< shape (N, width) rather than (N)
  std::uint64_t width = 1;  ///< elements a row; 0: the data set is absent
  std::uint64_t chunkRows = 1;
  unsigned deflate = 0;  ///< level of deflate, after shuffle and below the checksum; 0: neither
  bool chained = true;   ///< part of the content chain
  std::string unit;      ///< of the exported values; empty: none

  [[nodiscard]] std::size_t rowBytes() const { return elementBytes(element) * static_cast<std::size_t>(width); }
};

/// A golden recording: a digest in the place of forces; no observables, keyframes, fields' digests.
inline bool isMinimal(const AttemptHeader& header) { return header.purpose == "golden"; }

struct Layout {
  /// In the order of the chain: ticks, steps, events, keyframe index, keyframe bytes. Then raw samples, left and right.
  std::vector<Column> columns;
  std::size_t tickColumns = 0;                                   ///< the first ones
  std::size_t stepColumns = 0;                                   ///< the next ones
  std::size_t results = 0;                                       ///< place of the first of those below /observables
  std::size_t events = 0, keyframeIndex = 0, keyframeWords = 0;  ///< places of the others
  std::array<std::size_t, handCount> raw{};
  Column status, rawCounts;     ///< a row a flush
  bool deviceSamples = false;   ///< there is a /device
  bool minimal = false;         ///< isMinimal()
  bool brief = false;           ///< one digest of State and short ones of fields, in the place of those of components
  bool exactForces = false;     ///< version 1: forces are not rounded, and have a digest in golden recordings alone
  bool codedKeyframes = false;  ///< as differences from one another (keyframe_code.h)
  unsigned deflateLevel = 6;    ///< of what is deflated
  std::uint32_t ticksPerStep = 10;
  std::uint64_t stepsPerBlock = 25;  ///< max(1, 250 / ticksPerStep)
  std::uint64_t ticksPerBlock = 250;
  std::size_t components = 0, fields = 0;
  std::array<std::size_t, Tissues::count> count{};  ///< of each kind of tissue; 0 before the version that brought it
  std::size_t structures = 0;                       ///< that can be touched
  bool procedure = false;           ///< version 3 of StepResult, which held the judgement of a scene's procedure
  std::uint32_t resultVersion = 1;  ///< of StepResult: which columns there are

  explicit Layout(const AttemptHeader& header);

  /// How many columns of its kind of tissue a list of results has.
  template <class Result>
  [[nodiscard]] std::size_t countOf(const std::vector<Result>& /*parts*/) const {
    std::size_t found = 0;
    Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId id) {
      if constexpr (std::is_same_v<typename Kind::Result, Result>) found = count[id];
    });
    return found;
  }
};

/// Data set of the names of a kind of tissue: "/scene/organs".
template <class Kind>
std::string namesPath() {
  return "/scene" + std::string(Kind::results.path).substr(std::string_view("/observables").size());
}

/// Names of what a recording has of a kind of tissue, column by column. Kinds without structures are named by the
/// State's components.
std::vector<std::string> namesOfComponents(const AttemptHeader& header, std::string_view prefix);
template <class Kind>
std::vector<std::string> namesOf(const AttemptHeader& header) {
  if constexpr (Kind::hasStructures) {
    return Kind::namesOf(header);
  } else {
    return namesOfComponents(header, Kind::componentPrefix);
  }
}

/// Lists what one tick stores. A visitor is called with (folder, name, unit, value); `outside` is for what the chain
/// leaves out.
void visitTick(auto& s, auto& o, auto& visit) {
  static constexpr std::array<const char*, handCount> folder{"/ticks/left", "/ticks/right"};
  for (std::size_t h = 0; h < folder.size(); ++h) {
    visit(folder[h], "position", "m", s.hand[h].position);
    visit(folder[h], "orientation", "", s.hand[h].orientation);
    visit(folder[h], "instrument", "", s.hand[h].instrument);
    visit(folder[h], "jaw", "rad", s.hand[h].jaw);
    visit(folder[h], "buttons", "", s.hand[h].buttons);
    visit(folder[h], "valid", "", s.hand[h].valid);
    visit(folder[h], "contact_set", "", o.hand[h].contactSet);
    if (visit.layout.minimal) continue;
    visit(folder[h], "force", "N", o.hand[h].force);
    visit(folder[h], "torque", "N m", o.hand[h].torque);
  }
  visit("/camera", "position", "m", s.camera.position);
  visit("/camera", "orientation", "", s.camera.orientation);
  visit.outside("/ticks", "lateness", "s", o.lateness);
}

/// Hands the fields of a StepResult (sim/scene/step_result.h) to a visitor of columns.
template <class Visitor>
struct ResultColumns {
  Visitor& visit;

  template <class T>
  void one(const ResultGroup& group, const ResultField& field, T& value) {
    if constexpr (std::is_same_v<std::remove_const_t<T>, std::vector<double>>) {
      visit.list(group.path, field.name, field.unit, value, visit.layout.structures);
    } else {
      visit(group.path, field.name, unitOf(field), value);
    }
  }
  void each(const ResultGroup& group, const ResultField& field, auto& parts, auto member) {
    if (visit.layout.countOf(parts) > 0) visit.each(group.path, field.name, unitOf(field), parts, member);
  }

 private:
  /// Shares have none in titles.
  static const char* unitOf(const ResultField& field) {
    return field.unit[0] == '1' && field.unit[1] == '\0' ? "" : field.unit;
  }
};

/// Lists what a StepResult stores, but for its events.
template <class Result, class Visitor>
void visitResult(Result& r, Visitor& visit) {
  if (visit.layout.minimal) return;
  ResultColumns<Visitor> columns{visit};
  StepResult::fields(r, visit.layout.resultVersion, columns);
}

/// Lists what version 3 of StepResult stored of the procedure: the judgement of its time.
void visitProcedure(auto& p, auto& visit) {
  static constexpr const char* procedure = "/observables/procedure";
  visit(procedure, "phase", "", p.phase);
  visit(procedure, "triangle_cleared", "", p.triangleCleared);
  visit(procedure, "lower_third_freed", "", p.lowerThirdFreed);
  visit(procedure, "two_structures", "", p.twoStructures);
  visit(procedure, "critical_view_frozen", "", p.criticalViewFrozen);
  visit(procedure, "lower_third_attached", "", p.lowerThirdAttached);
  visit(procedure, "errors", "", p.errors);
  visit(procedure, "critical_errors", "", p.criticalErrors);
}

/// XXH3-64 of a step's forces and torques: tick by tick, left hand first.
std::uint64_t forceDigest(std::span<const TickOutcome> ticks);

/// A tick as version 2 stores it: forces rounded to 2^-14 N, torques to 2^-20 N m.
TickOutcome asStored(const TickOutcome& tick);

/// Takes a State's digest in the short form that version 2 stores.
void shorten(const StateDigest& digest, BriefDigest& out);

/// Lists what one step stores, but for its events. @param forces digest of its ticks' forces
void visitStep(auto& digest, auto& brief, auto& forces, auto& lateness, auto& r, auto& procedure, auto& visit) {
  const Layout& layout = visit.layout;
  if (layout.brief) {
    visit("/steps", "state_digest", "", brief.state);
    visit.list("/steps", "field_digest", "", brief.field, layout.fields);
  } else {
    visit.list("/steps", "component_digest", "", digest.component, layout.components);
    if (!layout.minimal) visit.list("/steps", "field_digest", "", digest.field, layout.fields);
  }
  if (layout.minimal || !layout.exactForces) visit("/steps", "force_digest", "", forces);
  visit.outside("/steps", "lateness", "s", lateness);
  visitResult(r, visit);
  if (visit.layout.procedure) visitProcedure(procedure, visit);
}

/// Lists the root attributes in the order of the chain. Values: std::string, std::uint32_t, std::uint64_t,
/// std::int64_t, double; `choice` is a string from a list.
void visitAttributes(auto& h, auto& visit) {
  visit.constant("format", std::string(formatName));
  visit("format_version", h.formatVersion);
  visit("attempt_uuid", h.attempt);
  visit("parent_uuid", h.parent);
  visit("fork_step", h.forkStep);
  visit("start_utc", h.startUtc);
  visit("software", h.software);
  visit("build", h.build);
  visit("simulation_version", h.simulationVersion);
  visit("step_result_version", h.stepResultVersion);
  visit("participant", h.participant);
  visit.choice("operator_kind", h.provenance.kind, operatorKindNames);
  visit("performer_profile", h.provenance.profile);
  visit("performer_version", h.provenance.profileVersion);
  visit("source_file", h.provenance.sourceFile);
  visit("source_sha256", h.provenance.sourceSha256);
  visit("device", h.provenance.device);
  visit("calibration", h.provenance.calibration);
  visit("station", h.station);
  visit.choice("mode", h.mode, modeNames);
  visit("purpose", h.purpose);
  visit("handedness", h.handedness);
  visit("seed", h.seed);
  visit("tick_seconds", h.tickSeconds);
  visit("ticks_per_step", h.ticksPerStep);
  visit("scene_name", h.sceneName);
  visit("scene_major", h.sceneMajor);
  visit("scene_minor", h.sceneMinor);
}

/// Hands root attributes to use(name, value); a choice is the string that it is stored as.
template <class Use>
struct AttributeValues {
  Use use;
  void operator()(const char* name, const auto& value) { use(name, value); }
  void constant(const char* name, const std::string& value) { use(name, value); }
  template <class T, std::size_t N>
  void choice(const char* name, const T& value, const std::array<const char*, N>& names) {
    use(name, std::string(names[static_cast<std::size_t>(value)]));
  }
};
template <class Use>
void forEachAttribute(const AttemptHeader& header, Use use) {
  AttributeValues<Use> values{std::move(use)};
  visitAttributes(header, values);
}

}  // namespace calot::recorder
