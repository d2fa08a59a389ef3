// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/assess.h"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/collector.h"
#include "analytics/external/metric_input.h"
#include "analytics/report/report_document.h"
#include "recorder/attempt.h"
#include "recorder/base/dates.h"
#include "recorder/formats/scene_file.h"

namespace calot::analytics {
namespace {

using ValuesOfAttempts = std::map<std::string, std::vector<CheckpointValue>>;

/// One column of the closing table.
struct SummaryColumn {
  const CheckpointDefinition* definition = nullptr;
  std::string subject;
  std::string title;  ///< "elapsed s", "path L mm", "liver burned %"
};

std::string columnTitle(const CheckpointEntry& entry, const std::string& subject) {
  const CheckpointDefinition& d = entry.definition;
  const std::string_view word = entry.place.summaryTitle;
  if (subject.empty()) return fmt::format("{} {}", word, d.displayUnit);
  if (d.aggregation != Aggregation::hand) return fmt::format("{} {} {}", subject, word, d.displayUnit);
  return fmt::format("{} {} {}", word, subject == handNames[0] ? "L" : "R", d.displayUnit);
}

/// The checkpoints that ask for columns, for every subject that some attempt has a value of.
std::vector<SummaryColumn> summaryColumns(const ValuesOfAttempts& values) {
  std::vector<SummaryColumn> columns;
  for (const CheckpointEntry& entry : checkpointRegistry()) {
    if (entry.place.summaryTitle.empty()) continue;
    std::vector<std::pair<std::string, bool>> subjects;  // in the order of values, and whether one has a value
    for (const auto& attempt : values) {
      for (const CheckpointValue& v : attempt.second) {
        if (v.name != entry.definition.name) continue;
        const auto same = [&](const auto& subject) { return subject.first == v.subject; };
        auto known = std::find_if(subjects.begin(), subjects.end(), same);
        if (known == subjects.end()) known = subjects.insert(known, {v.subject, false});
        known->second = known->second || v.value.has_value();
      }
    }
    for (const auto& [subject, any] : subjects) {
      if (any) columns.push_back({&entry.definition, subject, columnTitle(entry, subject)});
    }
  }
  return columns;
}

std::string figureText(const std::vector<CheckpointValue>& values, const SummaryColumn& column) {
  for (const CheckpointValue& v : values) {
    if (v.name != column.definition->name || v.subject != column.subject) continue;
    if (!v.value)
      return v.availability == Availability::notApplicable || v.availability == Availability::absentHand ? "n/a" : "-";
    return significant(*v.value * column.definition->displayFactor);
  }
  return "-";
}

/// A value's interval, and its parts: what step and mesh change, and the spread by constants. Empty where there is
/// none.
struct IntervalTexts {
  std::string interval;
  std::string parts;   ///< what step, mesh and constants add
  std::string remark;  ///< why there is no interval
};

IntervalTexts intervalTexts(const std::vector<ValueInterval>& intervals, const CheckpointValue& of, double factor) {
  const ValueInterval* found = findInterval(intervals, of);
  if (found == nullptr) return {};
  if (!found->lower) return {"none", "", "no interval: " + found->reason};
  if (*found->lower == *found->upper) return {"exact", "", ""};
  const auto shown = [&](double si) { return significant(si * factor); };
  const auto change = [&](double si) { return fmt::format("{}{}", si > 0.0 ? "+" : "", significant(si * factor, 2)); };
  return {fmt::format("[{}, {}]", shown(*found->lower), shown(*found->upper)),
          fmt::format("{}, {}, {}", change(found->stepEffect), change(found->meshEffect),
                      significant(found->constantsSpread * factor, 2)),
          ""};
}

Verdict verdictOf(recorder::ReplayVerdict verdict) {
  switch (verdict) {
    case recorder::ReplayVerdict::exact:
      return Verdict::verified;
    case recorder::ReplayVerdict::diverged:
      return Verdict::diverged;
    case recorder::ReplayVerdict::damaged:
      return Verdict::damaged;
    case recorder::ReplayVerdict::undecided:
      return Verdict::notCheckableHere;
    case recorder::ReplayVerdict::consistent:  // of a part: no assessment asks for one
      break;
  }
  return Verdict::notChecked;
}

}  // namespace

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
  if (report.verdict == recorder::ReplayVerdict::damaged) return judged;
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
  if (ofRecord || (report.verdict == recorder::ReplayVerdict::undecided && report.chainIntact)) {
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
  if (report.chainIntact && report.signature && report.signature->value) {
    RecordingSignature& s = a.signature.emplace();
    const auto key = std::as_bytes(std::span(report.signature->publicKey));
    const auto value = std::as_bytes(std::span(*report.signature->value));
    std::copy(key.begin(), key.end(), s.publicKey.begin());
    std::copy(value.begin(), value.end(), s.value.begin());
  }
  const bool exact = report.verdict == recorder::ReplayVerdict::exact;
  a.verification = {verdictOf(report.verdict), exact ? "" : report.message, recorder::softwareName()};
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

void printValues(const std::vector<CheckpointValue>& values, const std::vector<ValueInterval>& intervals,
                 std::ostream& out) {
  ReportTable table =
      tableOf("", {"=checkpoint", "value", "interval", "=unit", "step, mesh, constants", "=origin", "="});
  for (const CheckpointValue& v : values) {
    const CheckpointDefinition* definition = definitionOf(v);
    const std::string name = v.subject.empty() ? v.name : fmt::format("{} {}", v.name, v.subject);
    if (!v.value) {
      table.rows.push_back({name, "-", "", "", "", "", fmt::format("{}: {}", nameOf(v.availability), v.reason)});
      continue;
    }
    const double factor = definition != nullptr ? definition->displayFactor : 1.0;
    const auto [interval, parts, remark] = intervalTexts(intervals, v, factor);
    table.rows.push_back({name, significant(*v.value * factor), interval,
                          definition != nullptr ? definition->displayUnit : v.unit, parts, nameOf(v.origin),
                          v.note + (v.note.empty() || remark.empty() ? "" : "; ") + remark});
  }
  if (!table.rows.empty()) table.print(out, 120);  // reasons go on below
}

void printAttempts(const CohortDatabase& database, std::ostream& out) {
  ValuesOfAttempts values;
  for (AttemptValue& v : database.allValues()) values[v.attempt].push_back(std::move(v.value));
  ReportTable table = tableOf("", {"=attempt", "=who", "=scene", "=mode", "=outcome", "=verification", "=recording"});
  const std::vector<SummaryColumn> figures = summaryColumns(values);
  for (const SummaryColumn& figure : figures) table.columns.emplace_back(figure.title, Align::right);
  table.columns.emplace_back("", Align::left);
  std::size_t synthetic = 0;
  for (const AttemptRow& a : database.listAttempts()) {
    std::string who = a.participant;
    if (who.empty()) who = a.profile.empty() ? wordFor(a.operatorKind) : a.profile;
    std::vector<std::string> cells{a.uuid.substr(0, 8),
                                   who,
                                   fmt::format("{}/{}", a.scene, a.sceneMajor),
                                   wordFor(a.mode),
                                   a.complete ? wordFor(a.outcome) : "incomplete",
                                   nameOf(a.verification.verdict),
                                   a.fileName};
    for (const SummaryColumn& figure : figures) cells.push_back(figureText(values[a.uuid], figure));
    cells.push_back(fmt::format("{}{}", a.synthetic ? "SYNTHETIC" : "", a.excluded ? " excluded" : ""));
    synthetic += a.synthetic ? 1 : 0;
    table.rows.push_back(std::move(cells));
  }
  if (table.rows.empty()) {
    out << "no attempts\n";
    return;
  }
  table.print(out);
  out << fmt::format("{} attempts, {} of them synthetic\n", table.rows.size(), synthetic);
}

namespace {

std::array<std::byte, 32> bytesOf(const std::string& hexadecimal) {
  assert(hexadecimal.size() == 64);
  const auto digit = [](char c) { return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10); };
  std::array<std::byte, 32> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::byte>(digit(hexadecimal[2 * i]) * 16U + digit(hexadecimal[2 * i + 1]));
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

}  // namespace

AttemptRecord recordOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration) {
  AttemptRecord a;
  a.chainHead = bytesOf(motion.sha256);
  a.uuid = uuidOf(a.chainHead);
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
  stored.imported = database.storeAttempt(recordOf(motion, declaration), stored.values);
  return stored;
}

MetricOutcomes externalOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration,
                          const std::vector<MetricScript>& metrics) {
  if (metrics.empty()) return {};
  const TemporaryFolder input = writeMetricInput(motion, declaration.outcome, declaration.handedness, declaration.task);
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
    d.startUtc = word;
    return {};
  }
  assert(field == "participant");
  if (word.size() > 64) return "longer than 64 characters";
  d.participant = word;
  return {};
}

}  // namespace calot::analytics
