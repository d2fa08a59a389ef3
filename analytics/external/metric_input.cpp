// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/external/metric_input.h"

#include <fmt/format.h>
#include <cassert>
#include <cerrno>
#include <fstream>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include "recorder/base/errors.h"
#include "sim/judgement/judge.h"

namespace calot::analytics {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t headBytes = 128;  // a multiple of 64, with room for 20 digits of each dimension
constexpr std::size_t heldBack = 2048;  // numbers

}  // namespace

NpyColumn::NpyColumn(std::filesystem::path path, bool whole, std::size_t width)
    : path_(std::move(path)), whole_(whole), width_(width) {
  file_.reset(std::fopen(path_.c_str(), "wb"));
  if (!file_) fail();
  waiting_.reserve(heldBack);
  writeHead();
}

void NpyColumn::putBits(std::uint64_t bits) {
  waiting_.push_back(bits);
  ++numbers_;
  if (waiting_.size() == heldBack) flush();
}

void NpyColumn::clear() {
  assert(numbers_ == waiting_.size());
  waiting_.clear();
  numbers_ = 0;
}

void NpyColumn::flush() {
  if (std::fwrite(waiting_.data(), sizeof(std::uint64_t), waiting_.size(), file_.get()) != waiting_.size()) fail();
  waiting_.clear();
}

void NpyColumn::close() {
  assert(width_ == 0 || numbers_ % width_ == 0);
  flush();
  if (std::fseek(file_.get(), 0, SEEK_SET) != 0) fail();
  writeHead();
  if (std::fclose(file_.release()) != 0) fail();
}

void NpyColumn::writeHead() {
  const std::uint64_t rows = width_ == 0 ? numbers_ : numbers_ / width_;
  const std::string shape = width_ == 0 ? fmt::format("({},)", rows) : fmt::format("({}, {})", rows, width_);
  std::string text =
      fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': {}, }}", whole_ ? "<i8" : "<f8", shape);
  constexpr std::size_t before = 10;  // magic, version, length
  text.resize(headBytes - before - 1, ' ');
  text += '\n';
  const auto length = static_cast<std::uint16_t>(text.size());
  std::string head("\x93NUMPY\x01\x00", 8);
  head += static_cast<char>(length & 0xFFU);
  head += static_cast<char>(length >> 8U);
  head += text;
  if (std::fwrite(head.data(), 1, head.size(), file_.get()) != head.size()) fail();
}

void NpyColumn::fail() const {
  throw Error(ErrorKind::failure, Where{path_.string()},
              fmt::format("cannot be written: {}", std::generic_category().message(errno)));
}

InputColumns::InputColumns(const std::filesystem::path& folder, std::string table)
    : folder_(folder / table), table_(std::move(table)) {
  std::filesystem::create_directory(folder_);
}

NpyColumn& InputColumns::column(const std::string& name, const char* unit, const char* frame, bool whole,
                                std::size_t width, bool list) {
  if (!made_) {
    columns_.emplace_back(folder_ / (name + ".npy"), whole, list ? width : 0);
    description_.push_back({{"table", table_}, {"name", name}, {"unit", unit}, {"frame", frame}});
  }
  assert(next_ < columns_.size());
  return columns_[next_++];
}

void InputColumns::number(const std::string& name, const char* unit, double value) {
  column(name, unit, "", false, 0, false).put(value);
}

void InputColumns::whole(const std::string& name, std::int64_t value) {
  column(name, "", "", true, 0, false).put(value);
}

void InputColumns::vector(const std::string& name, const char* unit, const char* frame, const Vec3& value) {
  NpyColumn& c = column(name, unit, frame, false, 3, true);
  for (int i = 0; i < 3; ++i) c.put(value[i]);
}

void InputColumns::rotation(const std::string& name, const char* frame, const Quat& value) {
  NpyColumn& c = column(name, "", frame, false, 4, true);
  for (const double part : {value.w(), value.x(), value.y(), value.z()}) c.put(part);
}

void InputColumns::dropRows() {
  for (NpyColumn& c : columns_) c.clear();
}

void InputColumns::close() {
  for (NpyColumn& c : columns_) c.close();
}

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

MetricInput::MetricInput(const recorder::AttemptHeader& header, const SceneDescription& scene, Origin origin)
    : header_(header),
      judge_(scene),
      results_(folder_.path(), "results"),
      samples_(folder_.path(), "samples"),
      events_(folder_.path(), "events"),
      origin_(origin) {
  putEvent(events_, 0.0, Event{});
  events_.dropRows();
}

void MetricInput::onStep(const recorder::StepRecord& record) {
  const Judgement& judgement = judge_.observe(record.result);
  const std::uint64_t first = record.step * header_.ticksPerStep;
  const double tick = header_.tickSeconds;
  const double end = static_cast<double>(first + header_.ticksPerStep) * tick;
  for (std::size_t t = 0; t < record.samples.size(); ++t)
    putTick(samples_, static_cast<double>(first + t) * tick, record.samples[t], record.ticks[t]);
  results_.beginRow();
  results_.number("time", "s", end);
  results_.whole("phase", static_cast<std::int64_t>(judgement.phase));
  for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h)
    results_.number(std::string(handNames[h]) + "_force", "N", record.result.hand[h].contactForce.norm());
  StepResult::fields(record.result, header_.stepResultVersion, ResultVisitor{results_});
  results_.endRow();
  for (const Event& event : judgement.events) putEvent(events_, end, event);
}

void MetricInput::onEnd(recorder::Outcome outcome) {
  for (InputColumns* table : {&results_, &samples_, &events_}) table->close();
  const recorder::AttemptHeader& h = header_;
  const Json attempt{{"source", nameOf(origin_)},
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
  writeDescription(folder_.path(), attempt, h.structures(), {&results_, &samples_, &events_});
}

recorder::TemporaryFolder writeMetricInput(const recorder::TrackedMotion& motion, recorder::Outcome outcome,
                                           const std::string& handedness, const std::string& task) {
  recorder::TemporaryFolder folder;
  InputColumns samples(folder.path(), "samples");
  for (std::size_t i = 0; i < motion.time.size(); ++i) {
    samples.beginRow();
    samples.number("time", "s", motion.time[i]);
    for (std::size_t h = 0; h < static_cast<std::size_t>(handCount); ++h) {
      const recorder::TrackedHand& hand = motion.hand[h];
      const std::string name = std::string(handNames[h]) + "_";
      // Not a number: the script must not take what was left out for a sample.
      const Vec3 missing = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
      if (hand.present) samples.vector(name + "position", "m", "p_FI", hand.isMissing(i) ? missing : hand.position[i]);
      if (hand.present && hand.oriented) samples.rotation(name + "orientation", "q_FI", hand.orientation[i]);
      if (!hand.jaw.empty()) samples.number(name + "jaw", "rad", hand.jaw[i]);
      if (!hand.pedal.empty()) samples.whole(name + "pedal", hand.pedal[i] ? 1 : 0);
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
