// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assess.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/registry.h"
#include "analytics/external/metric_input.h"
#include "analytics/report/report_text.h"
#include "recorder/attempt.h"
#include "recorder/formats/scene_file.h"
#include "recorder/words.h"

namespace calot::analytics {
namespace {

using Align = TextTable::Align;

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

Assessment assessRecording(const std::string& file, const AssessSettings& wanted) {
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
  Assessment result;
  result.report = recorder::replayRecording(file, settings);
  const recorder::ReplayReport& report = result.report;
  if (report.verdict == recorder::ReplayVerdict::damaged) return result;
  // Opened once more only for what the replay did not tell: to read a short recording takes longer than to simulate it.
  std::optional<recorder::Recording> recording;
  const auto opened = [&]() -> recorder::Recording& { return recording ? *recording : recording.emplace(file); };
  if (header.attempt.empty()) header = opened().header();
  AssessedAttempt& assessed = result.attempt.emplace();
  assessed.header = std::move(header);
  assessed.outcome = report.outcome;
  assessed.complete = report.complete;
  assessed.steps = report.steps;
  assessed.chainHead = report.chainHead;
  if (const auto& signed_ = report.signature; report.chainIntact && signed_ && signed_->value) {
    RecordingSignature& s = assessed.signature.emplace();
    const auto byte = [](std::uint8_t b) { return static_cast<std::byte>(b); };
    std::transform(signed_->publicKey.begin(), signed_->publicKey.end(), s.publicKey.begin(), byte);
    std::transform(signed_->value->begin(), signed_->value->end(), s.value.begin(), byte);
  }
  const bool exact = report.verdict == recorder::ReplayVerdict::exact;
  assessed.verification = {verdictOf(report.verdict), exact ? "" : report.message, recorder::softwareName()};
  if (exact && collector) {
    assessed.values = collector->values();
    if (input) assessed.external = computeMetrics(*wanted.metrics, input->folder());
  }
  // An engine whose results are of an earlier version proves what is recorded; the values are of that.
  const bool ofRecord = exact && !collector;
  if (ofRecord || (report.verdict == recorder::ReplayVerdict::undecided && report.chainIntact)) {
    if (hasMetrics)
      input = std::make_unique<MetricInput>(
          opened().header(), recorder::sceneFromAssets(opened().header().assets).description, Origin::observables);
    assessed.values = valuesFromObservables(opened(), wanted.cutoff, input.get());
    if (input)
      assessed.external = computeMetrics(*wanted.metrics, input->folder(), "from recorded results, not re-simulated");
  }
  assessed.fileName = file;
  return result;
}

AttemptRecord recordOf(const AssessedAttempt& assessed) {
  const recorder::AttemptHeader& h = assessed.header;
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
  a.outcome = assessed.outcome;
  a.startUtc = h.startUtc;
  a.seed = h.seed;
  a.device = h.provenance.device;
  a.calibration = h.provenance.calibration;
  a.station = h.station;
  a.simulationVersion = h.simulationVersion;
  a.comparabilityKey = comparabilityKey(h);
  a.synthetic = h.provenance.kind == recorder::OperatorKind::performer;
  const std::size_t slash = assessed.fileName.find_last_of('/');
  a.fileName = slash == std::string::npos ? assessed.fileName : assessed.fileName.substr(slash + 1);
  a.complete = assessed.complete;
  a.steps = assessed.steps;
  a.stepSeconds = h.tickSeconds * static_cast<double>(h.ticksPerStep);
  a.chainHead = assessed.chainHead;
  a.signature = assessed.signature;
  a.verification = assessed.verification;
  return a;
}

JudgedRecording judgedRecording(Assessment assessment) {
  JudgedRecording judged;
  judged.report = std::move(assessment.report);
  if (assessment.attempt) {
    judged.record = recordOf(*assessment.attempt);
    judged.values = std::move(assessment.attempt->values);
    judged.external = std::move(assessment.attempt->external);
  }
  return judged;
}

bool isVerified(const CohortDatabase& database, const recorder::RecordingIdentity& recording) {
  const std::optional<AttemptRow> known = database.attempt(recording.attempt);
  return known && known->chainHead == recording.chainHead && known->complete == recording.complete &&
         known->verification.verdict == Verdict::verified;
}

Imported store(CohortDatabase& database, const AssessedAttempt& assessed) {
  return database.storeAttempt(recordOf(assessed), assessed.values);
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
  TextTable table({{"checkpoint", Align::left},
                   {"value", Align::right},
                   {"interval", Align::right},
                   {"unit", Align::left},
                   {"step, mesh, constants", Align::right},
                   {"origin", Align::left},
                   {"", Align::left}});
  for (const CheckpointValue& v : values) {
    const CheckpointDefinition* definition = definitionOf(v);
    const std::string name = v.subject.empty() ? v.name : fmt::format("{} {}", v.name, v.subject);
    if (!v.value) {
      table.add({name, "-", "", "", "", "", fmt::format("{}: {}", nameOf(v.availability), v.reason)});
      continue;
    }
    const double factor = definition != nullptr ? definition->displayFactor : 1.0;
    const auto [interval, parts, remark] = intervalTexts(intervals, v, factor);
    table.add({name, significant(*v.value * factor), interval, definition != nullptr ? definition->displayUnit : v.unit,
               parts, nameOf(v.origin), v.note + (v.note.empty() || remark.empty() ? "" : "; ") + remark});
  }
  if (table.rows() > 0) table.print(out, 120);  // reasons go on below
}

void printAttempts(const CohortDatabase& database, std::ostream& out) {
  ValuesOfAttempts values;
  for (AttemptValue& v : database.allValues()) values[v.attempt].push_back(std::move(v.value));
  std::vector<std::pair<std::string, Align>> columns{
      {"attempt", Align::left}, {"who", Align::left},          {"scene", Align::left},    {"mode", Align::left},
      {"outcome", Align::left}, {"verification", Align::left}, {"recording", Align::left}};
  const std::vector<SummaryColumn> figures = summaryColumns(values);
  for (const SummaryColumn& figure : figures) columns.emplace_back(figure.title, Align::right);
  columns.emplace_back("", Align::left);
  TextTable table(columns);
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
    table.add(std::move(cells));
  }
  if (table.rows() == 0) {
    out << "no attempts\n";
    return;
  }
  table.print(out);
  out << fmt::format("{} attempts, {} of them synthetic\n", table.rows(), synthetic);
}

}  // namespace calot::analytics
