// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/external/metric_input.h"

#include <fstream>
#include <string_view>
#include <type_traits>

#include "analytics/external/input_columns.h"
#include "recorder/base/errors.h"
#include "sim/judgement/judge.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t inputVersion = 1;
constexpr std::uint8_t noHand = 255;

/// "organs_" of "/observables/organs"; nothing of "/observables".
std::string prefixOf(const ResultGroup& group) {
  const std::string_view path(group.path), root("/observables/");
  return path.size() > root.size() ? std::string(path.substr(root.size())) + "_" : std::string();
}

/// Puts the fields of a StepResult into columns that are named as those of a recording: left_tip_real.
struct ResultVisitor {
  InputColumns& columns;

  template <class T>
  void one(const ResultGroup& group, const ResultField& field, const T& value) {
    const std::string name = prefixOf(group) + field.name;
    if constexpr (std::is_same_v<T, Vec3>) {
      columns.vector(name, field.unit, field.frame, value);
    } else if constexpr (std::is_same_v<T, Quat>) {
      columns.rotation(name, field.frame, value);
    } else if constexpr (std::is_floating_point_v<T>) {
      columns.number(name, field.unit, value);
    } else if constexpr (std::is_integral_v<T> || std::is_enum_v<T>) {
      columns.whole(name, static_cast<std::int64_t>(value));
    } else {
      columns.list(name, field.unit, value, [](const auto& v) { return v; });
    }
  }
  template <class Part, class T>
  void each(const ResultGroup& group, const ResultField& field, const std::vector<Part>& parts, T Part::*member) {
    columns.list(prefixOf(group) + field.name, field.unit, parts, [member](const Part& part) { return part.*member; });
  }
};

void putTick(InputColumns& columns, double time, const TickSamples& tick, const recorder::TickOutcome& outcome) {
  columns.beginRow();
  columns.number("time", "s", time);
  for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
    const std::string hand = std::string(handNames[h]) + "_";
    const InstrumentSample& s = tick.hand[h];
    columns.vector(hand + "position", "m", "p_WI", s.position);
    columns.rotation(hand + "orientation", "q_WI", s.orientation);
    columns.number(hand + "jaw", "rad", s.jaw);
    columns.whole(hand + "instrument", static_cast<std::int64_t>(s.instrument));
    columns.whole(hand + "buttons", s.buttons);
    columns.whole(hand + "valid", s.valid ? 1 : 0);
    columns.vector(hand + "force", "N", "f_W", outcome.hand[h].force);
    columns.vector(hand + "torque", "N m", "f_W", outcome.hand[h].torque);
  }
  columns.vector("camera_position", "m", "p_WC", tick.camera.position);
  columns.rotation("camera_orientation", "q_WC", tick.camera.orientation);
  columns.endRow();
}

void putEvent(InputColumns& columns, double time, const Event& event) {
  columns.beginRow();
  columns.number("time", "s", time);
  columns.whole("kind", static_cast<std::int64_t>(event.kind));
  columns.whole("hand", event.hand == noHand ? -1 : event.hand);
  columns.whole("subject", event.subject);
  columns.vector("position", "m", "p_W", event.position);
  columns.number("value", "", event.value);
  columns.endRow();
}

void writeDescription(const std::filesystem::path& folder, const Json& attempt, const Json& structures,
                      const std::vector<const InputColumns*>& tables) {
  Json columns = Json::array();
  for (const InputColumns* table : tables) {
    for (const auto& column : table->description()) columns.push_back(column);
  }
  const Json whole{{"format", "calot-metric-input"},
                   {"formatVersion", inputVersion},
                   {"attempt", attempt},
                   {"structures", structures},
                   {"columns", columns}};
  std::ofstream out(folder / "attempt.json", std::ios::binary);
  out << whole.dump(1, ' ', true, Json::error_handler_t::replace) << '\n';
  if (!out.flush()) throw Error(ErrorKind::failure, Where{(folder / "attempt.json").string()}, "cannot be written");
}

}  // namespace

struct MetricInput::Storage {
  Storage(const recorder::AttemptHeader& h, const SceneDescription& scene, Origin origin)
      : header(h),
        judge(scene),
        results(folder.path(), "results"),
        samples(folder.path(), "samples"),
        events(folder.path(), "events"),
        source(nameOf(origin)) {}
  TemporaryFolder folder;
  recorder::AttemptHeader header;
  Judge judge;
  InputColumns results, samples, events;
  std::string source;
};

MetricInput::MetricInput(const recorder::AttemptHeader& header, const SceneDescription& scene, Origin origin)
    : storage_(std::make_unique<Storage>(header, scene, origin)) {
  putEvent(storage_->events, 0.0, Event{});
  storage_->events.dropRows();
}

MetricInput::~MetricInput() = default;

void MetricInput::onStep(const recorder::StepRecord& record) {
  Storage& s = *storage_;
  const Judgement& judgement = s.judge.observe(record.result);
  const std::uint64_t first = record.step * s.header.ticksPerStep;
  const double tick = s.header.tickSeconds;
  const double end = static_cast<double>(first + s.header.ticksPerStep) * tick;
  for (std::size_t t = 0; t < record.samples.size(); ++t)
    putTick(s.samples, static_cast<double>(first + t) * tick, record.samples[t], record.ticks[t]);
  s.results.beginRow();
  s.results.number("time", "s", end);
  s.results.whole("phase", static_cast<std::int64_t>(judgement.phase));
  for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h)
    s.results.number(std::string(handNames[h]) + "_force", "N", record.result.hand[h].contactForce.norm());
  StepResult::fields(record.result, s.header.stepResultVersion, ResultVisitor{s.results});
  s.results.endRow();
  for (const Event& event : judgement.events) putEvent(s.events, end, event);
}

void MetricInput::onEnd(recorder::Outcome outcome) {
  Storage& s = *storage_;
  for (InputColumns* table : {&s.results, &s.samples, &s.events}) table->close();
  const recorder::AttemptHeader& h = s.header;
  const Json attempt{{"source", s.source},
                     {"scene", h.sceneName},
                     {"scene_major", h.sceneMajor},
                     {"scene_minor", h.sceneMinor},
                     {"operator", recorder::wordFor(h.provenance.kind)},
                     {"device", h.provenance.device},
                     {"mode", recorder::wordFor(h.mode)},
                     {"handedness", h.handedness},
                     {"outcome", recorder::wordFor(outcome)},
                     {"simulation_version", h.simulationVersion},
                     {"step_result_version", h.stepResultVersion},
                     {"tick_seconds", h.tickSeconds},
                     {"ticks_per_step", h.ticksPerStep}};
  writeDescription(s.folder.path(), attempt, h.structures(), {&s.results, &s.samples, &s.events});
}

const std::filesystem::path& MetricInput::folder() const { return storage_->folder.path(); }

TemporaryFolder writeMetricInput(const recorder::TrackedMotion& motion, recorder::Outcome outcome,
                                 const std::string& handedness, const std::string& task) {
  TemporaryFolder folder;
  InputColumns samples(folder.path(), "samples");
  for (std::size_t i = 0; i < motion.time.size(); ++i) {
    samples.beginRow();
    samples.number("time", "s", motion.time[i]);
    for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
      const recorder::TrackedHand& hand = motion.hand[h];
      const std::string name = std::string(handNames[h]) + "_";
      if (hand.present) samples.vector(name + "position", "m", "p_FI", hand.position[i]);
      if (hand.present && hand.oriented) samples.rotation(name + "orientation", "q_FI", hand.orientation[i]);
    }
    samples.endRow();
  }
  samples.close();
  const Json attempt{{"source", nameOf(Origin::samples)},
                     {"scene", task},
                     {"operator", "kinematics"},
                     {"device", motion.device},
                     {"frame", motion.frame},
                     {"handedness", handedness},
                     {"outcome", recorder::wordFor(outcome)}};
  writeDescription(folder.path(), attempt, Json::array(), {&samples});
  return folder;
}

}  // namespace calot::analytics
