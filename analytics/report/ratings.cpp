// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/ratings.h"

#include <algorithm>
#include <set>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/rating_table.h"

namespace calot::analytics {
namespace {

using Scores = std::map<std::string, std::vector<double>>;  ///< by attempt or participant

constexpr std::size_t minSubscale = 3;

const std::string& subjectOf(const Rating& r) { return r.attempt.empty() ? r.participant : r.attempt; }

std::optional<double> taken(const Expected<double>& answer) {
  return answer ? std::optional<double>(*answer) : std::nullopt;
}

ItemSummary summary(const Scores& scores) {
  ItemSummary s;
  std::vector<double> values;
  for (const auto& [subject, given] : scores) {
    if (given.empty()) {
      ++s.blank;
      continue;
    }
    values.push_back(*mean(given));
    for (const double score : given) ++s.counts[static_cast<int>(score)];
  }
  s.n = values.size();
  s.median = taken(median(values));
  s.lowerQuartile = taken(quantile(values, 0.25));
  s.upperQuartile = taken(quantile(values, 0.75));
  s.mean = taken(mean(values));
  return s;
}

/// A complete table of one figure; `figure` gives none where an item was left blank.
template <class Figure>
RatingTable tableOf(const std::map<std::string, std::map<std::string, const Rating*>>& byAttempt,
                    const std::set<std::string>& raters, Figure figure) {
  RatingTable table;
  table.raters = raters.size();
  for (const auto& [attempt, ratings] : byAttempt) {
    std::vector<double> row;
    for (const std::string& rater : raters) {
      const auto at = ratings.find(rater);
      const std::optional<double> value = at == ratings.end() ? std::nullopt : figure(*at->second);
      if (value) row.push_back(*value);
    }
    if (row.size() < raters.size()) continue;
    ++table.subjects;
    table.values.insert(table.values.end(), row.begin(), row.end());
  }
  return table;
}

Agreement agreementOn(const std::string& figure, const RatingTable& table) {
  Agreement a;
  a.figure = figure;
  a.attempts = table.subjects;
  a.raters = table.raters;
  a.single = intraclassCorrelation(table, IccForm::twoSingle);
  a.average = intraclassCorrelation(table, IccForm::twoAverage);
  return a;
}

void addAgreement(FormReport& report, const std::vector<FormItem>& items, const std::vector<const Rating*>& taken) {
  std::map<std::string, std::map<std::string, const Rating*>> byAttempt;
  std::set<std::string> raters;
  for (const Rating* r : taken) {
    byAttempt[r->attempt][r->rater] = r;
    raters.insert(r->rater);
  }
  const auto overall = [&](const Rating& r) -> std::optional<double> {
    double sum = 0.0;
    for (const FormItem& item : items) {
      const auto at = r.answers.find(item.key);
      if (at == r.answers.end()) return std::nullopt;
      sum += at->second;
    }
    return sum / static_cast<double>(items.size());
  };
  const RatingTable whole = tableOf(byAttempt, raters, overall);
  report.incomplete = byAttempt.size() - whole.subjects;
  if (items.size() > 1) report.agreement.push_back(agreementOn("mean of all items", whole));
  for (const FormItem& item : items) {
    const auto one = [&](const Rating& r) -> std::optional<double> {
      const auto at = r.answers.find(item.key);
      return at == r.answers.end() ? std::nullopt : std::optional<double>(at->second);
    };
    report.agreement.push_back(agreementOn(item.key, tableOf(byAttempt, raters, one)));
  }
}

void addConsistency(FormReport& report, const RatingForm& form, const std::vector<const Rating*>& taken) {
  for (const FormSection& section : form.sections) {
    if (section.items.size() < minSubscale) continue;
    RatingTable table;
    table.raters = section.items.size();
    for (const Rating* r : taken) {
      std::vector<double> row;
      for (const FormItem& item : section.items) {
        if (const auto at = r->answers.find(item.key); at != r->answers.end()) row.push_back(at->second);
      }
      if (row.size() < section.items.size()) continue;
      ++table.subjects;
      table.values.insert(table.values.end(), row.begin(), row.end());
    }
    report.sections.push_back({section.name, table.subjects, cronbachAlpha(table)});
  }
}

}  // namespace

FormReport reportForm(const RatingForm& form, const std::vector<Rating>& ratings,
                      const std::map<std::string, std::string>& groupOf, const std::vector<std::string>& groups) {
  FormReport report;
  report.name = form.name;
  report.version = form.version;
  report.title = form.title;
  report.source = form.source;
  report.ofAttempts = form.ofAttempts;
  report.least = form.least;
  report.most = form.most;
  report.groups = groups;
  std::vector<const Rating*> taken;
  for (const Rating& r : ratings) {
    if (r.form != form.name || r.formVersion != form.version) continue;
    const auto group = groupOf.find(subjectOf(r));
    if (group == groupOf.end() || std::find(groups.begin(), groups.end(), group->second) == groups.end()) {
      ++report.leftOut;
      continue;
    }
    taken.push_back(&r);
  }
  report.filled = taken.size();
  const std::vector<FormItem> items = form.items();
  for (const FormItem& item : items) {
    ItemReport row{item.key, item.text, item.primaryGroup, {}, {}};
    for (const std::string& group : groups) {
      Scores scores;
      for (const Rating* r : taken) {
        if (groupOf.at(subjectOf(*r)) != group) continue;
        std::vector<double>& given = scores[subjectOf(*r)];
        if (const auto at = r->answers.find(item.key); at != r->answers.end()) given.push_back(at->second);
      }
      row.groups.push_back(summary(scores));
      const auto mean = item.published.find(group);
      row.published.push_back(mean == item.published.end() ? std::nullopt : std::optional(mean->second));
    }
    report.items.push_back(std::move(row));
  }
  if (form.ofAttempts) {
    addAgreement(report, items, taken);
  } else {
    addConsistency(report, form, taken);
  }
  return report;
}

std::vector<FormReport> reportForms(const AssessmentDatabase& database,
                                    const std::map<std::string, std::string>& groupOf,
                                    const std::vector<std::string>& groups) {
  const std::vector<Rating> ratings = database.ratings();
  std::vector<FormReport> reports;
  for (const StoredDocument& stored : database.forms()) {
    const auto* bytes = reinterpret_cast<const std::byte*>(stored.text.data());
    const RatingForm form = parseRatingForm({bytes, stored.text.size()}, stored.name);
    reports.push_back(reportForm(form, ratings, groupOf, groups));
  }
  return reports;
}

}  // namespace calot::analytics
