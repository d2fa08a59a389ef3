// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assess.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "analytics/checkpoints/registry.h"
#include "analytics/report/text_table.h"
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

}  // namespace

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
  a.simulationVersion = h.simulationVersion;
  a.comparabilityKey = comparabilityKey(h);
  a.synthetic = h.provenance.kind == recorder::OperatorKind::performer;
  const std::size_t slash = assessed.fileName.find_last_of('/');
  a.fileName = slash == std::string::npos ? assessed.fileName : assessed.fileName.substr(slash + 1);
  a.complete = assessed.complete;
  a.steps = assessed.steps;
  a.stepSeconds = h.tickSeconds * static_cast<double>(h.ticksPerStep);
  a.chainHead = assessed.chainHead;
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
