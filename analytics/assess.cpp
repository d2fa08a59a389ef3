// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/assess.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/replay_words.h"
#include "analytics/external/metric_input.h"
#include "analytics/report/report_document.h"
#include "recorder/base/dates.h"
#include "recorder/base/files.h"
#include "recorder/formats/scene_file.h"
#include "recorder/loop.h"

namespace calot::analytics {
namespace {

/// Databases keep verdicts, replays report them. That of a part has no counterpart: no assessment asks for one.
constexpr std::array<std::pair<recorder::ReplayVerdict, Verdict>, 4> verdicts{{
    {recorder::ReplayVerdict::exact, Verdict::verified},
    {recorder::ReplayVerdict::diverged, Verdict::diverged},
    {recorder::ReplayVerdict::damaged, Verdict::damaged},
    {recorder::ReplayVerdict::undecided, Verdict::notCheckableHere},
}};

}  // namespace

Verdict verdictOf(recorder::ReplayVerdict verdict) {
  const auto at = std::find_if(verdicts.begin(), verdicts.end(), [&](const auto& v) { return v.first == verdict; });
  return at == verdicts.end() ? Verdict::notChecked : at->second;
}

recorder::ReplayVerdict verdictOf(Verdict verdict) {
  const auto at = std::find_if(verdicts.begin(), verdicts.end(), [&](const auto& v) { return v.second == verdict; });
  return at == verdicts.end() ? recorder::ReplayVerdict::undecided : at->first;
}

JudgedRecording assessRecording(const std::string& file, const AssessSettings& wanted) {
  recorder::AttemptHeader header;
  std::unique_ptr<CheckpointCollector> collector;
  std::unique_ptr<MetricInput> input;
  const bool hasMetrics = wanted.metrics != nullptr && !wanted.metrics->empty();
  recorder::ReplaySettings settings;
  settings.threads = wanted.threads;
  settings.engine = wanted.engine;
  settings.progress = wanted.progress;
  settings.observers = [&](const recorder::AttemptHeader& h, const SceneDescription& scene) {
    header = h;
    collector = std::make_unique<CheckpointCollector>(h, scene, Origin::resimulated, wanted.cutoff);
    std::vector<recorder::Observer*> observers{collector.get()};
    if (hasMetrics) {
      input = std::make_unique<MetricInput>(h, scene, Origin::resimulated);
      observers.push_back(input.get());
    }
    return observers;
  };
  JudgedRecording judged;
  judged.report = recorder::replayRecording(file, settings);
  const recorder::ReplayReport& report = judged.report;
  if (report.verdict == recorder::ReplayVerdict::damaged || report.steps == 0) return judged;
  // Opened once more only for what the replay did not tell: to read a short recording takes longer than to simulate it.
  std::optional<recorder::Recording> recording;
  const auto opened = [&]() -> recorder::Recording& { return recording ? *recording : recording.emplace(file); };
  if (header.attempt.empty()) header = opened().header();
  judged.record = recordOf(header, report, file);
  const bool exact = report.verdict == recorder::ReplayVerdict::exact;
  if (exact && collector) {
    judged.values = collector->values();
    if (input) judged.external = computeMetrics(*wanted.metrics, input->folder());
  }
  // An engine whose results are of an earlier version proves what is recorded; the values are of that.
  const bool ofRecord = exact && !collector;
  if (ofRecord || (report.verdict == recorder::ReplayVerdict::undecided && report.chainIntact())) {
    if (hasMetrics)
      input = std::make_unique<MetricInput>(header, recorder::sceneFromAssets(header.assets).description,
                                            Origin::observables);
    judged.values = valuesFromObservables(opened(), wanted.cutoff, input.get());
    if (input)
      judged.external = computeMetrics(*wanted.metrics, input->folder(), "from recorded results, not re-simulated");
  }
  return judged;
}

AttemptRecord recordOf(const recorder::AttemptHeader& h, const recorder::ReplayReport& report,
                       const std::string& file) {
  AttemptRecord a;
  a.uuid = h.attempt;
  a.parent = h.parent;
  a.participant = h.participant;
  a.scene = h.sceneName;
  a.sceneMajor = h.sceneMajor;
  a.sceneMinor = h.sceneMinor;
  a.operatorKind = h.provenance.kind;
  a.profile = h.provenance.profile;
  a.profileVersion = h.provenance.profileVersion;
  a.mode = h.mode;
  a.purpose = h.purpose;
  a.outcome = report.outcome;
  a.startUtc = h.startUtc;
  a.seed = h.seed;
  a.device = h.provenance.device;
  a.calibration = h.provenance.calibration;
  a.station = h.station;
  a.simulationVersion = h.simulationVersion;
  a.comparabilityKey = comparabilityKey(h);
  a.synthetic = h.provenance.kind == recorder::OperatorKind::performer;
  a.fileName = file.substr(file.find_last_of('/') + 1);
  a.complete = report.complete;
  a.steps = report.steps;
  a.stepSeconds = h.tickSeconds * static_cast<double>(h.ticksPerStep);
  a.chainHead = report.chainHead;
  if (report.chainIntact() && report.signature && report.signature->value) {
    RecordingSignature& s = a.signature.emplace();
    const auto key = std::as_bytes(std::span(report.signature->publicKey));
    const auto value = std::as_bytes(std::span(*report.signature->value));
    std::copy(key.begin(), key.end(), s.publicKey.begin());
    std::copy(value.begin(), value.end(), s.value.begin());
  }
  const bool exact = report.verdict == recorder::ReplayVerdict::exact;
  a.verification = {verdictOf(report.verdict), exact ? "" : wordsFor(report), recorder::softwareName()};
  return a;
}

bool isVerified(const CohortDatabase& database, const recorder::RecordingIdentity& recording) {
  const std::optional<AttemptRow> known = database.attempt(recording.attempt);
  return known && known->chainHead == recording.chainHead && known->complete == recording.complete &&
         known->verification.verdict == Verdict::verified;
}

bool storeExternal(CohortDatabase& database, const std::string& attempt, MetricOutcomes& external,
                   const std::vector<MetricScript>& metrics) {
  bool added = false;
  std::vector<CheckpointValue> stored;
  for (CheckpointValue& value : external.values) {
    try {
      added = database.storeExternal(attempt, {value}) == Imported::added || added;
      stored.push_back(std::move(value));
    } catch (const Error& e) {
      if (e.kind() != ErrorKind::refused) throw;
      const auto script = std::find_if(metrics.begin(), metrics.end(),
                                       [&](const MetricScript& m) { return m.metric() == value.metric; });
      external.failures.emplace_back(e.kind(), Where{script != metrics.end() ? script->file() : "", e.where().place},
                                     e.fault());
    }
  }
  external.values = std::move(stored);
  return added;
}

namespace {

std::array<std::byte, 32> bytesOf(const std::string& hexadecimal) {
  std::array<std::byte, 32> bytes{};
  recorder::readHex(hexadecimal, bytes);
  return bytes;
}

/// Custom content (version 8, RFC 9562): 122 bits of the hash.
std::string uuidOf(std::array<std::byte, 32> hash) {
  hash[6] = (hash[6] & std::byte{0x0f}) | std::byte{0x80};
  hash[8] = (hash[8] & std::byte{0x3f}) | std::byte{0x80};
  std::string uuid;
  for (std::size_t i = 0; i < 16; ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) uuid += '-';
    uuid += fmt::format("{:02x}", static_cast<unsigned>(hash[i]));
  }
  return uuid;
}

/// SHA-256 of the samples in nanoseconds, picometres and billionths of a unit quaternion; the least number: no sample.
std::array<std::byte, 32> motionHash(const recorder::TrackedMotion& motion) {
  std::vector<std::int64_t> numbers;
  std::size_t count = motion.time.size();
  for (const recorder::TrackedHand& hand : motion.hand) count += 1 + 7 * hand.position.size();
  numbers.reserve(count);
  const auto add = [&](double value, double scale) {
    numbers.push_back(std::isnan(value) ? std::numeric_limits<std::int64_t>::min() : std::llround(value * scale));
  };
  for (const double t : motion.time) add(t, 1e9);
  for (const recorder::TrackedHand& hand : motion.hand) {
    numbers.push_back((hand.present ? 1 : 0) + (hand.oriented ? 2 : 0));
    for (const Vec3& p : hand.position) {
      for (int i = 0; i < 3; ++i) add(p[i], 1e12);
    }
    for (std::size_t row = 0; row < hand.position.size(); ++row) {
      const Quat q = hand.orientationAt(row);
      for (const double part : {q.w(), q.x(), q.y(), q.z()}) add(part, q.w() < 0.0 ? -1e9 : 1e9);
    }
  }
  return bytesOf(recorder::sha256Hex(std::as_bytes(std::span(numbers))));
}

}  // namespace

AttemptRecord recordOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration) {
  AttemptRecord a;
  a.chainHead = bytesOf(motion.sha256);
  a.uuid = uuidOf(motionHash(motion));
  a.participant = declaration.participant;
  a.scene = declaration.task;
  a.operatorKind = recorder::OperatorKind::kinematics;
  a.mode = declaration.mode;
  a.purpose = declaration.purpose;
  a.outcome = declaration.outcome;
  a.startUtc = declaration.startUtc;
  a.device = motion.device;
  a.calibration = motion.frame.empty() ? std::string() : "frame-" + motion.frame;
  a.fileName = motion.file;
  a.complete = true;
  a.steps = motion.time.size() - 1;
  a.stepSeconds = motion.time.back() / static_cast<double>(a.steps);
  a.verification = {Verdict::notCheckableHere, "motion without a scene: there is nothing to simulate again",
                    recorder::softwareName()};
  recorder::AttemptHeader header;
  header.sceneName = a.scene;
  header.mode = a.mode;
  header.provenance.kind = a.operatorKind;
  header.provenance.device = a.device;
  header.provenance.calibration = a.calibration;
  a.comparabilityKey = comparabilityKey(header);
  return a;
}

StoredMotion storeMotion(CohortDatabase& database, const recorder::TrackedMotion& motion,
                         const MotionDeclaration& declaration) {
  StoredMotion stored;
  stored.values = valuesFromSamples(motion, {declaration.outcome, declaration.handedness, motionCutoff});
  AttemptRecord record = recordOf(motion, declaration);
  // Before the samples were the identity, the bytes were.
  record.uuid = database.uuidOfMotion(record.uuid, uuidOf(record.chainHead), record.chainHead);
  if (const std::optional<AttemptRow> known = database.attempt(record.uuid)) record.chainHead = known->chainHead;
  stored.attempt = record.uuid;
  stored.imported = database.storeAttempt(record, stored.values);
  return stored;
}

MetricOutcomes externalOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration,
                          const std::vector<MetricScript>& metrics) {
  if (metrics.empty()) return {};
  const recorder::TemporaryFolder input =
      writeMetricInput(motion, declaration.outcome, declaration.handedness, declaration.task);
  return computeMetrics(metrics, input.path());
}

namespace {

/// Sets `out` to the meaning of a word. @return empty, or the words that there are
template <class T>
std::string choose(T& out, const std::string& word, std::initializer_list<std::pair<const char*, T>> words) {
  std::string known;
  for (const auto& [name, meaning] : words) {
    if (word == name) {
      out = meaning;
      return {};
    }
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  return known + " is expected";
}

std::string setTask(std::string& task, const std::string& word) {
  if (word.size() > 60) return "1 to 60 characters are expected";
  for (const char c : word) {
    if (c <= ' ' || c > '~') return "a word without blanks is expected";
  }
  task = word;
  return {};
}

}  // namespace

std::string declareMotion(MotionDeclaration& d, std::string_view field, const std::string& word) {
  using recorder::Mode, recorder::Outcome;
  if (word.empty()) return {};
  if (field == "task") return setTask(d.task, word);
  if (field == "mode")
    return choose<Mode>(d.mode, word, {{"practice", Mode::practice}, {"assessment", Mode::assessment}});
  if (field == "purpose")
    return choose<std::string>(d.purpose, word, {{"training", "training"}, {"study", "study"}, {"demo", "demo"}});
  if (field == "handedness")
    return choose<std::string>(d.handedness, word, {{"right", "right"}, {"left", "left"}, {"unknown", "unknown"}});
  if (field == "outcome") {
    return choose<Outcome>(
        d.outcome, word,
        {{"completed", Outcome::completed}, {"abandoned", Outcome::abandoned}, {"stopped", Outcome::stopped}});
  }
  if (field == "start") {
    if (!recorder::isDate(word)) return "2026-01-31T12:00:00Z is expected";
    if (word > recorder::presentDate()) return "it is later than now; a start lies before its import";
    d.startUtc = word;
    return {};
  }
  assert(field == "participant");
  if (word.size() > 64) return "longer than 64 characters";
  d.participant = word;
  return {};
}

}  // namespace calot::analytics
