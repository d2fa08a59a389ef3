// SPDX-License-Identifier: GPL-3.0-or-later
// The columns of a recording, listed once (schemas/recording.md): data sets, writer, reader, recovery, export chain
// and comparison all run over this list. Internal to the recorder.
// So are the root attributes: written, read, hashed and exported by the same list.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
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

std::size_t elementBytes(Element element);
/// "u1" to "f8", as NumPy and the engines' protocol name them; empty for what is a row of several.
const char* numberType(Element element);

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

/// Packed rows of the compound data sets.
inline constexpr std::size_t eventBytes = 45;
inline constexpr std::size_t keyframeBytes = 32;
inline constexpr std::size_t statusBytes = 82;
inline constexpr std::size_t rawSampleBytes = 99;
inline constexpr std::size_t rawCountsBytes = 32;

/// A golden recording: a digest in the place of forces; no observables, keyframes, fields' digests.
inline bool isMinimal(const AttemptHeader& header) { return header.purpose == "golden"; }

struct Layout {
  /// In the order of the chain: ticks, steps, events, keyframe index, keyframe bytes. Then raw samples, left and right.
  std::vector<Column> columns;
  std::size_t tickColumns = 0;                                   ///< the first ones
  std::size_t stepColumns = 0;                                   ///< the next ones
  std::size_t events = 0, keyframeIndex = 0, keyframeWords = 0;  ///< places of the others
  std::array<std::size_t, handCount> raw{};
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
  template <class Parts, class Member>
  void each(const ResultGroup& group, const ResultField& field, Parts& parts, Member member) {
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
template <class Procedure, class Visitor>
void visitProcedure(Procedure& p, Visitor& visit) {
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
template <class Digest, class Brief, class Forces, class Lateness, class Result, class Procedure, class Visitor>
void visitStep(Digest& digest, Brief& brief, Forces& forces, Lateness& lateness, Result& r, Procedure& procedure,
               Visitor& visit) {
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

inline constexpr std::array<const char*, 3> operatorKindNames{"human", "kinematics", "performer"};
inline constexpr std::array<const char*, 2> modeNames{"practice", "assessment"};
inline constexpr std::array<const char*, 6> outcomeNames{"running",   "completed", "time_limit",
                                                         "abandoned", "stopped",   "technical_failure"};

/// Lists the root attributes in the order of the chain. Values: std::string, std::uint32_t, std::uint64_t,
/// std::int64_t, double; `choice` is a string from a list.
template <class Header, class Visitor>
void visitAttributes(Header& h, Visitor& visit) {
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

/// Reads every visited value from one row of its column, and finds the first that no writer makes. `place(column)` is
/// where that column's row lies.
template <class Place>
struct RowVisitor {
  const Layout& layout;
  Place place;  ///< where the row of a column lies, by its number
  std::size_t index = 0;
  bool input = false;  ///< samples must be finite; results too, but where the simulation ran away (unfinite)
  std::string fault;
  std::string unfinite = {};  ///< first result that is no finite number

  template <class T>
  void operator()(const char*, const char*, const char*, T& value) {
    std::memcpy(&value, at(), sizeof value);
    check(value);
    ++index;
  }
  void operator()(const char*, const char*, const char*, bool& value) {
    const auto byte = std::to_integer<unsigned>(*at());
    if (byte > 1) fail("is neither 0 nor 1");
    value = byte != 0;
    ++index;
  }
  void operator()(const char*, const char*, const char*, InstrumentKind& value) {
    const auto number = std::to_integer<unsigned>(*at());
    if (!isInstrumentNumber(number)) fail("is no known instrument");
    value = static_cast<InstrumentKind>(number);
    ++index;
  }
  void operator()(const char*, const char*, const char*, Cautery& value) {
    choice(value, Cautery::onTissue, "is no known state of the cautery");
  }
  void operator()(const char*, const char*, const char*, Phase& value) {
    choice(value, Phase::done, "is no known phase");
  }
  void operator()(const char*, const char*, const char*, Vec3& v) {
    std::memcpy(v.data(), at(), 3 * sizeof(double));
    if (!v.allFinite()) failUnfinite();
    ++index;
  }
  void operator()(const char*, const char*, const char*, Quat& q) {
    std::array<double, 4> wxyz{};
    std::memcpy(wxyz.data(), at(), sizeof wxyz);
    q = Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    const double norm = std::sqrt(wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]);
    if (input && !(std::abs(norm - 1.0) <= 1e-3)) fail("is not a unit quaternion within 1e-3");
    if (!std::isfinite(norm)) failUnfinite();
    ++index;
  }
  template <class T>
  void outside(const char*, const char*, const char*, T& value) {
    std::memcpy(&value, at(), sizeof value);
    if (!std::isfinite(value)) fail("is not finite");
    if (value < T{}) fail("is negative");
    ++index;
  }
  template <class T>
  void list(const char*, const char*, const char*, std::vector<T>& values, std::size_t width) {
    values.resize(width);
    if (width > 0) std::memcpy(values.data(), at(), width * sizeof(T));
    for (const T& v : values) check(v);
    ++index;
  }
  template <class Part, class T>
  void each(const char*, const char*, const char*, std::vector<Part>& parts, T Part::*member) {
    parts.resize(layout.countOf(parts));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::byte* value = at() + i * sizeof(T);
      if constexpr (std::is_same_v<T, bool>) {
        const auto byte = std::to_integer<unsigned>(*value);
        if (byte > 1) fail("is neither 0 nor 1");
        parts[i].*member = byte != 0;
      } else {
        std::memcpy(&(parts[i].*member), value, sizeof(T));
        check(parts[i].*member);
      }
    }
    ++index;
  }

 private:
  [[nodiscard]] const std::byte* at() const { return place(index); }
  /// A number from 0 to that of the last name.
  template <class Choice>
  void choice(Choice& value, Choice last, const char* why) {
    const auto code = std::to_integer<unsigned>(*at());
    if (code > static_cast<unsigned>(last)) fail(why);
    value = static_cast<Choice>(code);
    ++index;
  }
  template <class T>
  void check(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) failUnfinite();
    }
  }
  void failUnfinite() {
    std::string& whose = input ? fault : unfinite;
    if (whose.empty()) whose = fmt::format("{}[{{row}}] is not finite", layout.columns[index].path);
  }
  void fail(const char* why) {
    if (fault.empty()) fault = fmt::format("{}[{{row}}] {}", layout.columns[index].path, why);
  }
};

}  // namespace calot::recorder
