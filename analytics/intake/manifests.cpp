// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/intake/manifests.h"

#include <fmt/format.h>
#include <algorithm>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "analytics/assessment/rating_form.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {

ManifestTable::ManifestTable(CsvTable table, const std::vector<std::string>& known) : table_(std::move(table)) {
  const auto isKnown = [&](const std::string& column) {
    return column == "note" || std::any_of(known.begin(), known.end(), [&](const std::string& name) {
             return name.back() == ':' ? column.size() > name.size() && column.substr(0, name.size()) == name
                                       : column == name;
           });
  };
  for (const std::string& column : table_.columns) {
    if (!isKnown(column)) {
      std::string list;
      for (const std::string& name : known) list += name + (name.back() == ':' ? "..., " : ", ");
      throw Error(ErrorKind::invalid, Where{table_.path, "line 1"},
                  fmt::format("a column \"{}\" is not known here; rename or remove it (there are: {}note)",
                              recorder::shown(column), list));
    }
    static_cast<void>(table_.column(column));  // refuses what is there twice
  }
}

std::string ManifestTable::cell(const CsvRow& row, const std::string& column) const {
  const auto at = std::find(table_.columns.begin(), table_.columns.end(), column);
  return at == table_.columns.end() ? std::string() : row.cells[static_cast<std::size_t>(at - table_.columns.begin())];
}

std::filesystem::path ManifestTable::fileNamed(const std::string& cell) const {
  const std::filesystem::path file(cell);
  return file.is_absolute() ? file : std::filesystem::path(table_.path).parent_path() / file;
}

Error ManifestTable::fault(const CsvRow& row, const std::string& column, const std::string& what,
                           const std::vector<Remedy>& remedies) const {
  return {ErrorKind::damaged, Where{table_.path, fmt::format("line {}", row.line)},
          fmt::format("column \"{}\": {}", recorder::shown(column), what), remedies};
}

std::string attemptInTable(const CohortDatabase& cohort, const std::string& cell) {
  constexpr std::size_t least = 8;
  if (cell.size() < least)
    throw Error(ErrorKind::refused,
                fmt::format("\"{}\" is too little of an attempt's uuid; give {} letters of it, or all",
                            recorder::shown(cell), least));
  return cohort.attemptNamed(recorder::lowerCase(cell));
}

bool holdsControl(const std::string& name) {
  return std::any_of(name.begin(), name.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7F'; });
}

namespace {

using recorder::shown;

constexpr const char* subjectColumns[] = {"attempt", "file", "participant"};

using RatingKey = std::tuple<std::string, std::uint32_t, std::string, std::string, std::string>;
RatingKey keyOf(const Rating& r) { return {r.form, r.formVersion, r.attempt, r.rater, r.participant}; }

/// Attempts by what a table may call them.
class AttemptNames {
 public:
  explicit AttemptNames(const CohortDatabase& cohort) : cohort_(cohort) {
    for (const AttemptRow& a : cohort.listAttempts()) {
      files_[a.fileName].push_back(a.uuid);
      if (!a.participant.empty()) people_[a.participant].push_back(a.uuid);
    }
    for (const Participant& p : cohort.participants()) people_[p.pseudonym];
  }

  [[nodiscard]] bool isParticipant(const std::string& name) const { return people_.count(name) > 0; }

  /// @throws Error (refused) where there is none, or more than one.
  [[nodiscard]] std::string named(const std::string& column, const std::string& cell) const {
    if (column == "attempt") return attemptInTable(cohort_, cell);
    const auto& index = column == "file" ? files_ : people_;
    const auto at = index.find(column == "file" ? std::filesystem::path(cell).filename().string() : cell);
    const std::size_t found = at == index.end() ? 0 : at->second.size();
    if (found == 1) return at->second.front();
    throw Error(ErrorKind::refused,
                fmt::format("\"{}\" has {} in this cohort{}", shown(cell),
                            found == 0 ? "no attempt" : fmt::format("{} attempts", found),
                            found == 0 ? "" : "; name the one that was rated in a column \"attempt\""));
  }

 private:
  const CohortDatabase& cohort_;
  std::map<std::string, std::vector<std::string>> files_, people_;
};

class RatingReader {
 public:
  RatingReader(const ManifestTable& table, const std::vector<RatingForm>& forms, const AttemptNames& names,
               std::set<std::string> items)
      : table_(table), forms_(forms), names_(names), items_(std::move(items)) {}

  /// @throws Error naming line and column
  RatingRow take(const CsvRow& row, std::size_t number) {
    const RatingForm& form = forms_[number];
    RatingRow taken{row.line, number, {}};
    taken.rating.form = form.name;
    taken.rating.formVersion = form.version;
    readSubject(row, form, taken.rating);
    readRater(row, form, taken.rating);
    readAnswers(row, form, taken.rating);
    const auto [other, fresh] = lines_.emplace(keyOf(taken.rating), row.line);
    if (!fresh) {
      throw table_.fault(row, form.ofAttempts ? "rater" : "participant",
                         fmt::format("line {} rates the same with form {}; remove one", other->second, form.name));
    }
    return taken;
  }

 private:
  void readSubject(const CsvRow& row, const RatingForm& form, Rating& rating) const {
    std::string column, cell;
    for (const char* name : subjectColumns) {
      const std::string text = table_.cell(row, name);
      if (text.empty()) continue;
      if (!cell.empty()) throw table_.fault(row, name, fmt::format("column \"{}\" names the attempt already", column));
      column = name;
      cell = text;
    }
    if (cell.empty())
      throw table_.fault(row, "attempt", "is empty; name what was rated by attempt, file or participant");
    if (!form.ofAttempts) {
      if (column != "participant" || !names_.isParticipant(cell)) {
        throw table_.fault(
            row, column,
            fmt::format("form {} is filled in by a participant, and \"{}\" is not one", form.name, shown(cell)));
      }
      rating.participant = cell;
      return;
    }
    try {
      rating.attempt = names_.named(column, cell);
    } catch (const Error& e) {
      throw table_.fault(row, column, e.fault());
    }
  }

  void readRater(const CsvRow& row, const RatingForm& form, Rating& rating) const {
    const std::string rater = table_.cell(row, "rater");
    if (form.ofAttempts) {
      try {
        checkParticipant({rater, "", "", "", {}, {}});
      } catch (const Error&) {
        throw table_.fault(
            row, "rater",
            rater.empty() ? "is empty; every row needs its rater" : "is not a pseudonym of 1 to 64 letters");
      }
      rating.rater = rater;
    } else if (!rater.empty()) {
      throw table_.fault(row, "rater", fmt::format("form {} is filled in by the participant alone", form.name));
    }
  }

  void readAnswers(const CsvRow& row, const RatingForm& form, Rating& rating) const {
    std::vector<std::pair<std::string, std::string>> given;
    std::set<std::string> own;
    for (const FormItem& item : form.items()) {
      own.insert(item.key);
      if (!table_.has(item.key))
        throw table_.fault(row, item.key, fmt::format("form {} has it, and there is no such column", form.name));
      const std::string cell = table_.cell(row, item.key);
      given.emplace_back(item.key, cell.empty() || cell == "NA" ? "-" : table_.withPoint(cell));
    }
    for (const std::string& other : items_) {
      if (own.count(other) == 0 && !table_.cell(row, other).empty())
        throw table_.fault(row, other, fmt::format("form {} has no such item", form.name));
    }
    try {
      rating.answers = answersOf(form, given);
    } catch (const Error& e) {
      throw Error(ErrorKind::damaged, Where{table_.path(), fmt::format("line {}", row.line)}, e.what());
    }
  }

  const ManifestTable& table_;
  const std::vector<RatingForm>& forms_;
  const AttemptNames& names_;
  std::set<std::string> items_;  ///< of all forms
  std::map<RatingKey, std::size_t> lines_;
};

}  // namespace

RatingManifest readRatingManifest(const std::string& path, const std::string& form, const FindForm& find,
                                  const CohortDatabase& cohort, recorder::SimilarNames similar,
                                  std::vector<Error>& faults) {
  CsvTable read = readCsvTable(path);
  std::vector<recorder::NameColumn> people{{"participant"}, {"rater"}};
  for (const Participant& p : cohort.participants()) people[0].known.push_back(p.pseudonym);
  for (const Rating& r : cohort.ratings()) people[1].known.push_back(r.rater);
  recorder::spellNames(read, people, similar);
  std::vector<RatingForm> forms;
  std::map<std::string, std::size_t> numberOf;
  const auto nameIn = [&](const CsvRow& row) {
    const std::string cell = read.has("form") ? row.cells[read.column("form")] : std::string();
    return cell.empty() ? form : cell;
  };
  std::set<std::string> items;
  for (const CsvRow& row : read.rows) {
    const std::string name = nameIn(row);
    if (name.empty()) {
      throw Error(ErrorKind::invalid, Where{path, fmt::format("line {}", row.line)},
                  "names no form; name one in a column \"form\", or for all rows");
    }
    if (!numberOf.emplace(name, forms.size()).second) continue;
    forms.push_back(readRatingForm(find(name)));
    for (const FormItem& item : forms.back().items()) items.insert(item.key);
  }
  std::vector<std::string> known{"form", "attempt", "file", "participant", "rater"};
  known.insert(known.end(), items.begin(), items.end());
  const ManifestTable table(std::move(read), known);
  RatingManifest manifest;
  manifest.path = path;
  for (const RatingForm& f : forms) manifest.forms.push_back({f.name, f.version, f.sha256, f.text});
  const AttemptNames names(cohort);
  RatingReader reader(table, forms, names, items);
  for (const CsvRow& row : table.rows()) {
    const std::string cell = table.cell(row, "form");
    try {
      manifest.rows.push_back(reader.take(row, numberOf.at(cell.empty() ? form : cell)));
    } catch (const Error& e) {
      faults.push_back(e);
    }
  }
  return manifest;
}

StoredRatings storeRatings(CohortDatabase& database, const RatingManifest& manifest, bool replace,
                           std::vector<Error>& faults) {
  std::map<RatingKey, Rating> before;
  for (Rating& r : database.ratings()) {
    const RatingKey key = keyOf(r);
    before.emplace(key, std::move(r));
  }
  StoredRatings stored;
  std::vector<std::pair<std::size_t, Rating>> changed;
  for (const RatingRow& row : manifest.rows) {
    const auto at = before.find(keyOf(row.rating));
    if (at == before.end()) {
      ++stored.added;
    } else if (at->second.answers == row.rating.answers) {
      ++stored.unchanged;
      continue;
    } else if (replace) {
      ++stored.replaced;
    } else {
      faults.emplace_back(ErrorKind::refused, Where{manifest.path, fmt::format("line {}", row.line)},
                          fmt::format("was stored on {} with other answers", at->second.ratedUtc),
                          std::vector<Remedy>{Remedy::replaceExisting});
    }
    changed.emplace_back(row.form, row.rating);
  }
  if (!faults.empty()) return {};
  database.storeRatings(manifest.forms, changed, replace);
  return stored;
}

}  // namespace calot::analytics
