// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/intake/manifests.h"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include "analytics/assess.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

namespace fs = std::filesystem;
using recorder::shown;

constexpr std::string_view criterionPrefix = "experience:";
constexpr const char* declared[] = {"task", "participant", "mode", "purpose", "handedness", "outcome", "start"};

using Details = std::map<std::string, std::string>;
/// Columns of a row about its participant.
constexpr std::pair<const char*, std::string Participant::*> textColumns[] = {
    {"group", &Participant::group}, {"arm", &Participant::arm}, {"site", &Participant::site}};
constexpr std::pair<const char*, Details Participant::*> pairColumns[] = {{"experience", &Participant::experience},
                                                                          {"consent", &Participant::consent}};

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == std::string::npos ? std::string() : text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// "name<mark>value" pairs between semicolons. @return empty, or the fault
std::string readPairs(const std::string& cell, char mark, const char* form, std::map<std::string, std::string>& out) {
  for (std::size_t from = 0; from <= cell.size();) {
    const std::size_t end = std::min(cell.find(';', from), cell.size());
    const std::string item = trimmed(cell.substr(from, end - from));
    from = end + 1;
    if (item.empty()) continue;
    const std::size_t at = item.find(mark);
    if (at == std::string::npos || at == 0 || at + 1 == item.size())
      return fmt::format("\"{}\": {} is expected, several between semicolons", shown(item), form);
    if (!out.emplace(trimmed(item.substr(0, at)), trimmed(item.substr(at + 1))).second)
      return fmt::format("{} is given twice", shown(item.substr(0, at)));
  }
  return {};
}

/// Adds what one row says of a participant. @return empty, or what contradicts
std::string combine(std::string& known, const std::string& more) {
  if (more.empty() || known == more) return {};
  if (!known.empty()) return fmt::format("\"{}\", and \"{}\" before", shown(more), shown(known));
  known = more;
  return {};
}

std::string combine(std::map<std::string, std::string>& known, const std::map<std::string, std::string>& more) {
  for (const auto& [name, value] : more) {
    if (const std::string fault = combine(known[name], value); !fault.empty()) return shown(name) + " " + fault;
  }
  return {};
}

/// Reads rows in turn, with what earlier ones said.
class Reader {
 public:
  Reader(const ManifestTable& table, MotionManifest& manifest, const MotionDeclaration& otherwise, std::string columns,
         const recorder::DateStyle& dates)
      : table_(table), manifest_(manifest), otherwise_(otherwise), columns_(std::move(columns)), dates_(dates) {}

  /// @throws Error (damaged) for a wrong row.
  void take(const CsvRow& row) {
    MotionRow taken{row.line, {}, {}, otherwise_};
    readFile(row, taken);
    for (const char* field : declared) {
      std::string word = table_.cell(row, field);
      if (field == std::string_view("start")) readDate(row, field, recorder::readMoment, word);
      if (const std::string wanted = declareMotion(taken.declaration, field, word); !wanted.empty())
        throw table_.fault(row, field, fmt::format("\"{}\": {}", shown(word), wanted));
    }
    readParticipant(row, taken.declaration.participant);
    manifest_.rows.push_back(std::move(taken));
  }

 private:
  /// Rewrites a date as ISO 8601; an empty cell stays.
  void readDate(const CsvRow& row, const char* column, decltype(recorder::readDay)& read, std::string& date) const {
    try {
      if (!date.empty()) date = read(date, dates_);
    } catch (const Error& e) {
      throw table_.fault(row, column, e.fault(), e.remedies());
    }
  }

  void readFile(const CsvRow& row, MotionRow& taken) {
    const std::string cell = table_.cell(row, "file");
    if (cell.empty()) throw table_.fault(row, "file", "is empty; every row needs its file");
    taken.file = table_.fileNamed(cell);
    std::error_code ignored;
    if (!fs::is_regular_file(taken.file, ignored)) {
      throw table_.fault(row, "file",
                         fmt::format("there is no file \"{}\"; paths are relative to the manifest", shown(cell)));
    }
    const auto [other, fresh] = files_.emplace(fs::weakly_canonical(taken.file, ignored), row.line);
    if (!fresh) {
      throw table_.fault(row, "file",
                         fmt::format("\"{}\" is that of line {} already; remove one", shown(cell), other->second));
    }
    const std::string map = table_.cell(row, "columns");
    taken.columns = map.empty() ? columns_ : table_.fileNamed(map).string();
    if (taken.columns.empty() && !recorder::isKinematicsFile(taken.file)) {
      try {
        recorder::recognisedMap(taken.file);
      } catch (const Error& e) {
        throw table_.fault(row, table_.has("columns") ? "columns" : "file",
                           fmt::format("{}; a map of a file's columns is named in a column \"columns\"", e.what()));
      }
    }
    if (!taken.columns.empty() && manifest_.maps.count(taken.columns) == 0) {
      try {
        manifest_.maps.emplace(taken.columns, recorder::readColumnMap(taken.columns));
      } catch (const Error& e) {
        throw table_.fault(row, "columns", e.what());
      }
    }
  }

  void readParticipant(const CsvRow& row, const std::string& pseudonym) {
    Participant p;
    for (const auto& [column, member] : textColumns) p.*member = table_.cell(row, column);
    const auto ask = [&](const char* column, const std::string& fault) {
      if (!fault.empty()) throw table_.fault(row, column, fault);
    };
    ask("experience", readPairs(table_.cell(row, "experience"), '=', "CRITERION=VALUE", p.experience));
    ask("consent", readPairs(table_.cell(row, "consent"), ':', "PURPOSE:YYYY-MM-DD", p.consent));
    for (auto& [purpose, day] : p.consent) readDate(row, "consent", recorder::readDay, day);
    for (const std::string& column : table_.columns()) {
      const std::string value = table_.cell(row, column);
      if (column.substr(0, criterionPrefix.size()) != criterionPrefix || value.empty()) continue;
      if (!p.experience.emplace(column.substr(criterionPrefix.size()), value).second)
        throw table_.fault(row, column, "is given in column \"experience\", too");
    }
    for (const auto& [column, member] : textColumns) {
      if (holdsControl(p.*member)) throw table_.fault(row, column, "holds a line break or a control character");
    }
    if (pseudonym.empty()) {
      if (p == Participant()) return;
      throw table_.fault(row, "participant", "is empty; a group or experience is a participant's");
    }
    p.pseudonym = pseudonym;
    try {
      checkParticipant(p);
    } catch (const Error& e) {
      throw table_.fault(row, "participant", e.what());
    }
    const auto [at, fresh] = manifest_.participants.emplace(pseudonym, p);
    manifest_.lineOf.emplace(pseudonym, row.line);
    if (fresh) return;
    Participant& known = at->second;
    for (const auto& [column, member] : textColumns) ask(column, combine(known.*member, p.*member));
    for (const auto& [column, member] : pairColumns) ask(column, combine(known.*member, p.*member));
  }

  const ManifestTable& table_;
  MotionManifest& manifest_;
  const MotionDeclaration& otherwise_;
  std::string columns_;
  const recorder::DateStyle& dates_;
  std::map<fs::path, std::size_t> files_;  ///< line of each
};

}  // namespace

MotionManifest readMotionManifest(const std::string& path, const MotionDeclaration& otherwise,
                                  const std::string& columns, const TableReading& reading,
                                  const std::vector<Participant>& enrolled, std::vector<Error>& faults) {
  std::vector<std::string> known{"file", "columns", "group", "arm", "site", "experience", "experience:", "consent"};
  known.insert(known.end(), std::begin(declared), std::end(declared));
  CsvTable read = readCsvTable(path);
  std::vector<recorder::NameColumn> names{{"participant"}};
  for (const Participant& p : enrolled) names[0].known.push_back(p.pseudonym);
  for (const auto& [column, member] : textColumns) {
    names.push_back({column});
    for (const Participant& p : enrolled) names.back().known.push_back(p.*member);
  }
  recorder::spellNames(read, names, reading.names);
  const ManifestTable table(std::move(read), known);
  if (!table.has("file"))
    throw Error(ErrorKind::invalid, Where{path, "line 1"}, "there is no column \"file\"; a manifest names its files");
  MotionManifest manifest;
  manifest.path = path;
  if (!columns.empty()) manifest.maps.emplace(columns, recorder::readColumnMap(columns));
  Reader reader(table, manifest, otherwise, columns, reading.dates);
  for (const CsvRow& row : table.rows()) {
    try {
      reader.take(row);
    } catch (const Error& e) {
      faults.push_back(e);
    }
  }
  return manifest;
}

Enrolment::Enrolment(const CohortDatabase& database) : path_(database.path()) {
  for (Participant& p : database.participants()) known_.emplace(p.pseudonym, p);
}

Participant Enrolment::additionsOf(const Participant& wanted) const {
  const auto at = known_.find(wanted.pseudonym);
  if (at == known_.end()) return wanted;
  const Participant& known = at->second;
  Participant more;
  const auto fill = [&](const std::string& what, const std::string& before, const std::string& value) {
    if (before.empty() || before == value || value.empty()) return before.empty() ? value : std::string();
    throw Error(ErrorKind::refused, Where{path_},
                fmt::format("participant \"{}\" has {} \"{}\", not \"{}\"", shown(wanted.pseudonym), what,
                            shown(before), shown(value)),
                {Remedy::changeParticipant});
  };
  for (const auto& [what, member] : textColumns) more.*member = fill(what, known.*member, wanted.*member);
  for (const auto& [what, member] : pairColumns) {
    for (const auto& [name, value] : wanted.*member) {
      const auto before = (known.*member).find(name);
      const std::string added =
          fill(fmt::format("{} {}", what, shown(name)), before == (known.*member).end() ? "" : before->second, value);
      if (!added.empty()) (more.*member)[name] = added;
    }
  }
  return more;
}

void Enrolment::add(CohortDatabase& database, const Participant& wanted) {
  const auto [at, isNew] = known_.emplace(wanted.pseudonym, wanted);
  if (isNew) {
    database.addParticipant(wanted);
    return;
  }
  const Participant more = additionsOf(wanted);
  if (more == Participant()) return;
  const auto given = [](const std::string& text) { return text.empty() ? std::nullopt : std::optional(text); };
  database.setParticipant(wanted.pseudonym,
                          {given(more.group), given(more.arm), given(more.site), more.experience, more.consent});
  Participant& known = at->second;
  for (const auto& [what, member] : textColumns) {
    if (!(more.*member).empty()) known.*member = more.*member;
  }
  for (const auto& [what, member] : pairColumns) (known.*member).insert((more.*member).begin(), (more.*member).end());
}

std::vector<Error> Enrolment::conflicts(const MotionManifest& manifest) const {
  std::vector<Error> conflicts;
  for (const auto& [pseudonym, participant] : manifest.participants) {
    try {
      static_cast<void>(additionsOf(participant));
    } catch (const Error& e) {
      conflicts.emplace_back(e.kind(), Where{manifest.path, fmt::format("line {}", manifest.lineOf.at(pseudonym))},
                             e.what(), e.remedies());
    }
  }
  return conflicts;
}

}  // namespace calot::analytics
