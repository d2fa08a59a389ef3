// SPDX-License-Identifier: GPL-3.0-or-later
// Results of forms as tables and sentences.

#include "analytics/report/rating_tables.h"

#include <fmt/format.h>
#include <algorithm>

#include "analytics/report/ratings.h"
#include "analytics/report/report_text.h"

namespace calot::analytics {
namespace {

using Align = TextTable::Align;

std::string withInterval(double value, const Expected<Interval>& interval) {
  if (!interval) return fmt::format("{:.3f}", value);
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", value, interval->lower, interval->upper);
}

std::string iccText(const Expected<IntraclassCorrelation>& icc) {
  return icc ? withInterval(icc->value, icc->interval) : "- (" + icc.reason() + ")";
}

/// A group of which nobody filled in this form has no rows.
std::vector<std::size_t> groupsThatAnswered(const FormReport& report) {
  std::vector<std::size_t> answered;
  for (std::size_t g = 0; g < report.groups.size(); ++g) {
    if (std::any_of(report.items.begin(), report.items.end(),
                    [&](const ItemReport& item) { return item.groups[g].n + item.groups[g].blank > 0; }))
      answered.push_back(g);
  }
  return answered;
}

/// Titles and cells of what both tables say of a group's scores.
void addSummaryColumns(ReportTable& table) {
  for (const char* title : {"n", "blank", "median", "quartile 1", "quartile 3", "mean"})
    table.columns.emplace_back(title, Align::right);
}

void addSummary(std::vector<std::string>& row, const ItemSummary& s) {
  row.push_back(fmt::format("{}", s.n));
  row.push_back(s.blank == 0 ? "" : fmt::format("{}", s.blank));
  for (const std::optional<double>& value : {s.median, s.lowerQuartile, s.upperQuartile, s.mean})
    row.push_back(significantOrDash(value, 3));
}

std::string groupName(const std::string& group) { return group.empty() ? "(no group)" : group; }

ReportTable answersTable(const FormReport& report) {
  ReportTable table{fmt::format("{} ({} {})", report.title, report.name, report.version),
                    {{"item", Align::left}, {"group", Align::left}, {"", Align::left}},
                    {}};
  addSummaryColumns(table);
  table.columns.emplace_back("paper", Align::right);
  table.columns.emplace_back("answers", Align::left);
  const std::vector<std::size_t> answered = groupsThatAnswered(report);
  for (const ItemReport& item : report.items) {
    for (const std::size_t g : answered) {
      const ItemSummary& s = item.groups[g];
      std::string counts;
      for (const auto& [score, count] : s.counts)
        counts += fmt::format("{}{}: {}", counts.empty() ? "" : ", ", score, count);
      std::vector<std::string> row{
          g == answered.front() ? item.text : "", groupName(report.groups[g]),
          report.groups[g] == item.primaryGroup && !item.primaryGroup.empty() ? "primary" : ""};
      addSummary(row, s);
      row.push_back(item.published[g] ? fmt::format("{}", *item.published[g]) : "");
      row.push_back(counts);
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

ReportTable scalesTable(const FormReport& report) {
  ReportTable table{fmt::format("Sums of {}", report.name),
                    {{"scale", Align::left}, {"range", Align::left}, {"group", Align::left}},
                    {}};
  addSummaryColumns(table);
  table.columns.emplace_back("mean of an item", Align::right);
  const std::vector<std::size_t> answered = groupsThatAnswered(report);
  for (const ScaleReport& scale : report.scales) {
    const auto items = static_cast<int>(scale.items);
    for (const std::size_t g : answered) {
      const ItemSummary& s = scale.groups[g];
      const bool first = g == answered.front();
      std::vector<std::string> row{first ? scale.name : "",
                                   first ? fmt::format("{} to {}", report.least * items, report.most * items) : "",
                                   groupName(report.groups[g])};
      addSummary(row, s);
      row.push_back(
          significantOrDash(s.mean ? std::optional(*s.mean / static_cast<double>(scale.items)) : std::nullopt, 3));
      table.rows.push_back(std::move(row));
    }
  }
  return table;
}

ReportTable consistencyTable(const FormReport& report) {
  ReportTable table{fmt::format("Internal consistency of {}", report.name),
                    {{"subscale", Align::left}, {"n", Align::right}, {"Cronbach's alpha", Align::left}},
                    {}};
  for (const SectionConsistency& s : report.sections) {
    table.rows.push_back({s.section, fmt::format("{}", s.n),
                          s.alpha ? withInterval(s.alpha->value, s.alpha->interval) : "- (" + s.alpha.reason() + ")"});
  }
  return table;
}

ReportTable agreementTable(const FormReport& report) {
  ReportTable table{fmt::format("Agreement between raters on {}", report.name),
                    {{"figure", Align::left},
                     {"attempts", Align::right},
                     {"raters", Align::right},
                     {"ICC(2,1), one rater", Align::left},
                     {"ICC(2,k), their mean", Align::left}},
                    {}};
  for (const Agreement& a : report.agreement) {
    table.rows.push_back(
        {a.figure, fmt::format("{}", a.attempts), fmt::format("{}", a.raters), iccText(a.single), iccText(a.average)});
  }
  return table;
}

}  // namespace

std::vector<std::string> ratingNotes(const FormReport& report) {
  std::vector<std::string> notes;
  if (report.filled == 0) return notes;
  notes.push_back(fmt::format("{}: {} forms, {} of people or attempts that are not analysed left out. {}Items: {}.",
                              report.name, report.filled, report.leftOut,
                              report.ofAttempts
                                  ? fmt::format("One value a participant: of an attempt the mean of its "
                                                "raters, of several attempts the mean; agreement over the "
                                                "first attempt of each that every rater rated ({} were "
                                                "not, {} are later ones). ",
                                                report.incomplete, report.repeated)
                                  : "primary: the group whose judgement counts first. ",
                              report.source));
  const auto warn = [&](CoveredInterval interval, const std::string& name, std::uint64_t n, const char* unit) {
    if (const std::string text = coverageWarning(interval, name, n, n, unit); !text.empty())
      notes.push_back("Warning: " + text + ".");
  };
  // Figures of one size share their warning.
  std::uint64_t attempts = 0;
  for (const Agreement& a : report.agreement) {
    const bool single = a.single && a.single->interval, average = a.average && a.average->interval;
    if (a.attempts == attempts) continue;
    attempts = a.attempts;
    if (single) warn(CoveredInterval::iccSingle, "ICC(2,1)", a.attempts, "attempts");
    if (average) warn(CoveredInterval::iccAverage, "ICC(2,k)", a.attempts, "attempts");
  }
  std::uint64_t people = 0;
  for (const SectionConsistency& s : report.sections) {
    if (s.n == people || !s.alpha || !s.alpha->interval) continue;
    people = s.n;
    warn(CoveredInterval::alpha, "Cronbach's alpha", s.n, "people");
  }
  return notes;
}

std::vector<ReportTable> ratingTables(const FormReport& report) {
  std::vector<ReportTable> tables;
  if (report.filled == 0) return tables;
  for (ReportTable table :
       {answersTable(report), scalesTable(report), consistencyTable(report), agreementTable(report)}) {
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  return tables;
}

namespace {

using Json = nlohmann::ordered_json;

Json orNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json intervalJson(const Expected<Interval>& i) {
  if (!i) return {{"value", nullptr}, {"reason", i.reason()}};
  return {{"lower", i->lower}, {"upper", i->upper}, {"level", i->level}, {"method", i->method}};
}

template <class T>
Json estimateJson(const Expected<T>& answer) {
  if (!answer) return {{"value", nullptr}, {"reason", answer.reason()}};
  return {{"value", answer->value}, {"interval", intervalJson(answer->interval)}};
}

Json itemJson(const FormReport& report, const ItemReport& item) {
  Json groups = Json::array();
  for (std::size_t g = 0; g < report.groups.size(); ++g) {
    const ItemSummary& s = item.groups[g];
    Json counts = Json::object();
    for (const auto& [score, count] : s.counts) counts[std::to_string(score)] = count;
    groups.push_back({{"group", report.groups[g]},
                      {"primary", !item.primaryGroup.empty() && report.groups[g] == item.primaryGroup},
                      {"n", s.n},
                      {"blank", s.blank},
                      {"median", orNull(s.median)},
                      {"lower_quartile", orNull(s.lowerQuartile)},
                      {"upper_quartile", orNull(s.upperQuartile)},
                      {"mean", orNull(s.mean)},
                      {"published_mean", orNull(item.published[g])},
                      {"counts", counts}});
  }
  return {{"item", item.key}, {"text", item.text}, {"groups", groups}};
}

}  // namespace

nlohmann::ordered_json ratingsJson(const std::vector<FormReport>& reports) {
  Json all = Json::array();
  for (const FormReport& r : reports) {
    Json j{{"form", r.name},     {"version", r.version},       {"title", r.title},
           {"source", r.source}, {"filled", r.filled},         {"left_out", r.leftOut},
           {"groups", r.groups}, {"incomplete", r.incomplete}, {"items", Json::array()}};
    for (const ItemReport& item : r.items) j["items"].push_back(itemJson(r, item));
    j["scales"] = Json::array();
    for (const ScaleReport& s : r.scales) {
      Json groups = Json::array();
      for (std::size_t g = 0; g < r.groups.size(); ++g) {
        const ItemSummary& of = s.groups[g];
        groups.push_back({{"group", r.groups[g]},
                          {"n", of.n},
                          {"blank", of.blank},
                          {"median", orNull(of.median)},
                          {"lower_quartile", orNull(of.lowerQuartile)},
                          {"upper_quartile", orNull(of.upperQuartile)},
                          {"mean", orNull(of.mean)},
                          {"mean_of_an_item",
                           orNull(of.mean ? std::optional(*of.mean / static_cast<double>(s.items)) : std::nullopt)}});
      }
      j["scales"].push_back({{"scale", s.name}, {"items", s.items}, {"groups", groups}});
    }
    j["consistency"] = Json::array();
    for (const SectionConsistency& s : r.sections)
      j["consistency"].push_back({{"section", s.section}, {"n", s.n}, {"alpha", estimateJson(s.alpha)}});
    j["agreement"] = Json::array();
    for (const Agreement& a : r.agreement) {
      j["agreement"].push_back({{"figure", a.figure},
                                {"attempts", a.attempts},
                                {"raters", a.raters},
                                {"icc_2_1", estimateJson(a.single)},
                                {"icc_2_k", estimateJson(a.average)}});
    }
    all.push_back(j);
  }
  return all;
}

}  // namespace calot::analytics
