// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/ratings.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace calot::analytics {
namespace {

template <class T>
ValueTree estimateTree(const Expected<T>& estimate) {
  return treeOf(estimate, [](const T& e) { return ValueTree{{"value", e.value}, {"interval", e.interval}}; });
}

ValueTree summaryTree(const std::string& group, const ItemSummary& s) {
  return {{"group", group},
          {"n", s.n},
          {"blank", s.blank},
          {"median", s.median},
          {"lower_quartile", s.lowerQuartile},
          {"upper_quartile", s.upperQuartile},
          {"mean", s.mean}};
}

ValueTree itemTree(const FormReport& report, const ItemReport& item) {
  ValueTree groups = ValueTree::array();
  for (std::size_t g = 0; g < report.groups.size(); ++g) {
    const ItemSummary& s = item.groups[g];
    ValueTree counts = ValueTree::object();
    for (const auto& [score, count] : s.counts) counts[std::to_string(score)] = count;
    ValueTree& group = groups.emplace_back(ValueTree{
        {"group", report.groups[g]}, {"primary", !item.primaryGroup.empty() && report.groups[g] == item.primaryGroup}});
    group.update(summaryTree(report.groups[g], s));
    group.update({{"published_mean", item.published[g]}, {"counts", counts}});
  }
  return {{"item", item.key}, {"text", item.text}, {"groups", groups}};
}

ValueTree formTree(const FormReport& r) {
  ValueTree items = ValueTree::array(), scales = ValueTree::array(), consistency = ValueTree::array(),
            agreement = ValueTree::array();
  for (const ItemReport& item : r.items) items.push_back(itemTree(r, item));
  for (const ScaleReport& s : r.scales) {
    ValueTree groups = ValueTree::array();
    for (std::size_t g = 0; g < r.groups.size(); ++g) {
      const std::optional<double>& mean = s.groups[g].mean;
      groups.push_back(summaryTree(r.groups[g], s.groups[g]));
      groups.back()["mean_of_an_item"] = mean ? std::optional(*mean / static_cast<double>(s.items)) : std::nullopt;
    }
    scales.push_back({{"scale", s.name}, {"items", s.items}, {"groups", groups}});
  }
  for (const SectionConsistency& s : r.sections)
    consistency.push_back({{"section", s.section}, {"n", s.n}, {"alpha", estimateTree(s.alpha)}});
  for (const Agreement& a : r.agreement) {
    agreement.push_back({{"figure", a.figure},
                         {"attempts", a.attempts},
                         {"raters", a.raters},
                         {"icc_2_1", estimateTree(a.single)},
                         {"icc_2_k", estimateTree(a.average)}});
  }
  return {{"form", r.name},     {"version", r.version},  {"title", r.title},           {"source", r.source},
          {"filled", r.filled}, {"left_out", r.leftOut}, {"groups", r.groups},         {"incomplete", r.incomplete},
          {"items", items},     {"scales", scales},      {"consistency", consistency}, {"agreement", agreement}};
}

// Texts of cells.
std::string estimateText(const ValueTree& estimate) {
  if (!estimate.contains("interval")) return "- (" + plain(estimate["reason"]) + ")";
  const ValueTree& interval = estimate["interval"];
  return share3(estimate["value"]) + (interval.contains("lower") ? " " + shares3(interval) : "");
}
std::string groupText(const ValueTree& group) { return group == "" ? "(no group)" : plain(group); }
std::string countAboveZero(const ValueTree& count) { return count == 0 ? "" : plain(count); }
std::string primaryText(const ValueTree& primary) { return primary == true ? "primary" : ""; }
std::string publishedText(const ValueTree& mean) { return mean.is_null() ? "" : fmt::format("{}", mean.get<double>()); }
std::string countsText(const ValueTree& counts) {
  std::string text;
  for (const auto& [score, count] : counts.items())
    text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", score, count.dump());
  return text;
}

/// The groups of every item or scale, one below the other, without those in which nobody filled in this form. The first
/// of each has its item's `names`.
ValueTree groupRows(const ValueTree& form, const ValueTree& items, const std::vector<std::string>& names) {
  ValueTree rows = ValueTree::array();
  const auto answered = [&](std::size_t g) {
    return std::any_of(form["items"].begin(), form["items"].end(), [&](const ValueTree& item) {
      return item["groups"][g]["n"].get<int>() + item["groups"][g]["blank"].get<int>() > 0;
    });
  };
  for (const ValueTree& item : items) {
    bool first = true;
    for (std::size_t g = 0; g < item["groups"].size(); ++g) {
      if (!answered(g)) continue;
      ValueTree& row = rows.emplace_back(item["groups"][g]);
      for (const std::string& name : names) row[name] = first ? item[name] : ValueTree(nullptr);
      first = false;
    }
  }
  return rows;
}

const std::vector<TreeColumn> scoreColumns{{"n", "/n", plain},
                                           {"blank", "/blank", countAboveZero},
                                           {"median", "/median", digits3},
                                           {"quartile 1", "/lower_quartile", digits3},
                                           {"quartile 3", "/upper_quartile", digits3},
                                           {"mean", "/mean", digits3}};

/// Titles and cells of a group's scores between others.
ReportTable summaryTable(const std::string& title, const ValueTree& rows, std::vector<TreeColumn> columns,
                         const std::vector<TreeColumn>& behind) {
  columns.insert(columns.end(), scoreColumns.begin(), scoreColumns.end());
  columns.insert(columns.end(), behind.begin(), behind.end());
  return tableOf(title, rows, columns);
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
  ValueTree form = formTree(report);
  for (ValueTree& scale : form["scales"]) {
    const int items = scale["items"];
    scale["range"] = fmt::format("{} to {}", report.least * items, report.most * items);
  }
  for (ReportTable table :
       {summaryTable(fmt::format("{} ({} {})", report.title, report.name, report.version),
                     groupRows(form, form["items"], {"text"}),
                     {{"=item", "/text", plain}, {"=group", "/group", groupText}, {"=", "/primary", primaryText}},
                     {{"paper", "/published_mean", publishedText}, {"=answers", "/counts", countsText}}),
        summaryTable("Sums of " + report.name, groupRows(form, form["scales"], {"scale", "range"}),
                     {{"=scale", "/scale", plain}, {"=range", "/range", plain}, {"=group", "/group", groupText}},
                     {{"mean of an item", "/mean_of_an_item", digits3}}),
        tableOf("Internal consistency of " + report.name, form["consistency"],
                {{"=subscale", "/section", plain}, {"n", "/n", plain}, {"=Cronbach's alpha", "/alpha", estimateText}}),
        tableOf("Agreement between raters on " + report.name, form["agreement"],
                {{"=figure", "/figure", plain},
                 {"attempts", "/attempts", plain},
                 {"raters", "/raters", plain},
                 {"=ICC(2,1), one rater", "/icc_2_1", estimateText},
                 {"=ICC(2,k), their mean", "/icc_2_k", estimateText}})}) {
    if (!table.rows.empty()) tables.push_back(std::move(table));
  }
  return tables;
}

ValueTree ratingsTree(const std::vector<FormReport>& reports) {
  ValueTree forms = ValueTree::array();
  for (const FormReport& report : reports) forms.push_back(formTree(report));
  return forms;
}

}  // namespace calot::analytics
