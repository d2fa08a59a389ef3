// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assess.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>

#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/from_observables.h"
#include "analytics/checkpoints/registry.h"
#include "analytics/report/text_table.h"
#include "recorder/attempt.h"
#include "recorder/words.h"

namespace calot::analytics {
namespace {

using Align = TextTable::Align;

/// The figures of the closing table, in their display units.
struct MainFigure {
  const char* title;
  const char* name;
  const char* subject;
};
constexpr MainFigure mainFigures[] = {
    {"elapsed s", "elapsed-time", ""},           {"path L mm", "path-length", "left"},
    {"path R mm", "path-length", "right"},       {"fat %", "fat-remaining", ""},
    {"in %", "fat-remaining-inside", ""},        {"out %", "fat-remaining-outside", ""},
    {"cystic s", "cystic-contact-time", ""},     {"connective %", "connective-remaining", ""},
    {"liver burned %", "organ-burned", "liver"}, {"gallbladder burned %", "organ-burned", "gallbladder"},
    {"duration s", "attempt-duration", ""},
};

std::string figureText(const std::vector<CheckpointValue>& values, const MainFigure& figure) {
  for (const CheckpointValue& v : values) {
    if (v.name != figure.name || v.subject != figure.subject) continue;
    const CheckpointDefinition* definition = findCheckpoint(v.name);
    if (!v.value) return v.availability == Availability::notApplicable ? "n/a" : "-";
    return significant(*v.value * (definition != nullptr ? definition->displayFactor : 1.0));
  }
  return "-";
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
  }
  return Verdict::notChecked;
}

}  // namespace

Assessment assessRecording(const std::string& file, unsigned threads, double cutoff) {
  recorder::AttemptHeader header;
  std::unique_ptr<CheckpointCollector> collector;
  recorder::ReplaySettings settings;
  settings.threads = threads;
  settings.observers = [&](const recorder::AttemptHeader& h, const Model& model) {
    header = h;
    collector = std::make_unique<CheckpointCollector>(h, model.scene(), Origin::resimulated, cutoff);
    return std::vector<recorder::Observer*>{collector.get()};
  };
  Assessment result;
  result.report = recorder::replayRecording(file, settings);
  const recorder::ReplayReport& report = result.report;
  if (report.verdict == recorder::ReplayVerdict::damaged) return result;
  recorder::Recording recording(file);
  if (header.attempt.empty()) header = recording.header();
  AssessedAttempt& assessed = result.attempt.emplace();
  assessed.header = std::move(header);
  assessed.outcome = report.outcome;
  assessed.complete = report.complete;
  assessed.steps = report.steps;
  assessed.chainHead = report.chainHead;
  if (const auto& signed_ = recording.signature(); report.chainIntact && signed_ && signed_->value) {
    RecordingSignature& s = assessed.signature.emplace();
    const auto byte = [](std::uint8_t b) { return static_cast<std::byte>(b); };
    std::transform(signed_->publicKey.begin(), signed_->publicKey.end(), s.publicKey.begin(), byte);
    std::transform(signed_->value->begin(), signed_->value->end(), s.value.begin(), byte);
  }
  const bool exact = report.verdict == recorder::ReplayVerdict::exact;
  assessed.verification = {verdictOf(report.verdict), exact ? "" : report.message, recorder::softwareName()};
  if (exact) assessed.values = collector->values();
  if (report.verdict == recorder::ReplayVerdict::undecided && report.chainIntact)
    assessed.values = valuesFromObservables(recording, cutoff);
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

Imported store(CohortDatabase& database, const AssessedAttempt& assessed) {
  return database.storeAttempt(recordOf(assessed), assessed.values);
}

void printValues(const std::vector<CheckpointValue>& values, std::ostream& out) {
  TextTable table({{"checkpoint", Align::left},
                   {"value", Align::right},
                   {"unit", Align::left},
                   {"origin", Align::left},
                   {"", Align::left}});
  for (const CheckpointValue& v : values) {
    const CheckpointDefinition* definition = findCheckpoint(v.name);
    const std::string name = v.subject.empty() ? v.name : fmt::format("{} {}", v.name, v.subject);
    if (!v.value) {
      const char* missing = v.availability == Availability::notApplicable ? "not applicable" : "not available";
      table.add({name, "-", "", "", fmt::format("{}: {}", missing, v.reason)});
      continue;
    }
    table.add({name, significant(*v.value * (definition != nullptr ? definition->displayFactor : 1.0)),
               definition != nullptr ? definition->displayUnit : v.unit, nameOf(v.origin), v.note});
  }
  if (table.rows() > 0) table.print(out);
}

void printAttempts(const CohortDatabase& database, std::ostream& out) {
  std::map<std::string, std::vector<CheckpointValue>> values;
  for (AttemptValue& v : database.allValues()) values[v.attempt].push_back(std::move(v.value));
  std::vector<std::pair<std::string, Align>> columns{
      {"attempt", Align::left}, {"who", Align::left},          {"scene", Align::left},    {"mode", Align::left},
      {"outcome", Align::left}, {"verification", Align::left}, {"recording", Align::left}};
  std::vector<MainFigure> figures;  // those that some attempt has
  for (const MainFigure& figure : mainFigures) {
    const bool any = std::any_of(values.begin(), values.end(), [&](const auto& attempt) {
      return std::any_of(attempt.second.begin(), attempt.second.end(), [&](const CheckpointValue& v) {
        return v.value && v.name == figure.name && v.subject == figure.subject;
      });
    });
    if (!any) continue;
    figures.push_back(figure);
    columns.emplace_back(figure.title, Align::right);
  }
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
    for (const MainFigure& figure : figures) cells.push_back(figureText(values[a.uuid], figure));
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
