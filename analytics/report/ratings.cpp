// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/ratings.h"

#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/reliability.h"

namespace calot::analytics {
namespace {

/// By participant, then by attempt ("" where the form is the participant's).
using Scores = std::map<std::string, std::map<std::string, std::vector<double>>>;
using Attempts = std::map<std::string, AttemptOf>;

constexpr std::size_t minSubscale = 3;

const std::string& subjectOf(const Rating& r) { return r.attempt.empty() ? r.participant : r.attempt; }

std::string participantOf(const std::string& subject, const Attempts& attempts) {
  const auto at = attempts.find(subject);
  return at == attempts.end() || at->second.participant.empty() ? subject : at->second.participant;
}

ItemSummary summary(const Scores& scores) {
  ItemSummary s;
  std::vector<double> values;
  for (const auto& [participant, attempts] : scores) {
    std::vector<double> means;
    for (const auto& [attempt, given] : attempts) {
      if (!given.empty()) means.push_back(*mean(given));
      for (const double score : given) ++s.counts[static_cast<int>(score)];
    }
    if (means.empty()) {
      ++s.blank;
    } else {
      values.push_back(*mean(means));
    }
  }
  static_cast<Summary&>(s) = summaryOf(values);
  return s;
}

struct RatedAttempt {
  std::string startUtc, uuid, participant;
  std::map<std::string, const Rating*> ratings;  ///< by rater
};

/// A complete table of one figure, a row a participant; `figure` gives none where an item was left blank.
/// @param rated by start. @param[out] repeated complete attempts of those who have a row already
template <class Figure>
RatingTable scoresOf(const std::vector<RatedAttempt>& rated, const std::set<std::string>& raters, Figure figure,
                     std::uint64_t& repeated) {
  RatingTable table;
  table.raters = raters.size();
  std::set<std::string> seen;
  repeated = 0;
  for (const RatedAttempt& attempt : rated) {
    const auto& ratings = attempt.ratings;
    std::vector<double> row;
    for (const std::string& rater : raters) {
      const auto at = ratings.find(rater);
      const std::optional<double> value = at == ratings.end() ? std::nullopt : figure(*at->second);
      if (value) row.push_back(*value);
    }
    if (row.size() < raters.size()) continue;
    if (!seen.insert(attempt.participant).second) {
      ++repeated;
      continue;
    }
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

constexpr const char* allItems = "Global rating (all items)";

/// The sum of a form's items with these keys; none where one was left blank.
std::optional<double> sumOf(const Rating& rating, const std::vector<std::string>& keys) {
  double sum = 0.0;
  for (const std::string& key : keys) {
    const auto at = rating.answers.find(key);
    if (at == rating.answers.end()) return std::nullopt;
    sum += at->second;
  }
  return sum;
}

/// The form's subscales, then all of its items.
std::vector<FormSubscale> scalesOf(const RatingForm& form) {
  std::vector<FormSubscale> scales = form.subscales;
  FormSubscale whole{allItems, {}};
  for (const FormItem& item : form.items()) whole.items.push_back(item.key);
  if (whole.items.size() > 1) scales.push_back(std::move(whole));
  return scales;
}

/// For each group a summary of the sums of these items.
std::vector<ItemSummary> summaries(const std::vector<std::string>& keys, const std::vector<std::string>& groups,
                                   const std::vector<const Rating*>& taken,
                                   const std::map<std::string, std::string>& groupOf, const Attempts& attempts) {
  std::vector<ItemSummary> result;
  for (const std::string& group : groups) {
    Scores scores;
    for (const Rating* r : taken) {
      if (groupOf.at(subjectOf(*r)) != group) continue;
      std::vector<double>& given = scores[participantOf(subjectOf(*r), attempts)][r->attempt];
      if (const std::optional<double> sum = sumOf(*r, keys)) given.push_back(*sum);
    }
    result.push_back(summary(scores));
  }
  return result;
}

void addAgreement(FormReport& report, const RatingForm& form, const std::vector<FormItem>& items,
                  const std::vector<const Rating*>& taken, const Attempts& attempts) {
  std::map<std::string, std::map<std::string, const Rating*>> byAttempt;
  std::set<std::string> raters;
  for (const Rating* r : taken) {
    byAttempt[r->attempt][r->rater] = r;
    raters.insert(r->rater);
  }
  std::vector<RatedAttempt> rated;
  for (auto& [uuid, ratings] : byAttempt) {
    const auto at = attempts.find(uuid);
    rated.push_back({at == attempts.end() ? std::string() : at->second.startUtc, uuid, participantOf(uuid, attempts),
                     std::move(ratings)});
  }
  std::sort(rated.begin(), rated.end(), [](const RatedAttempt& a, const RatedAttempt& b) {
    return a.startUtc != b.startUtc ? a.startUtc < b.startUtc : a.uuid < b.uuid;
  });
  const auto agreeOn = [&](const std::string& figure, const std::vector<std::string>& keys, double divisor,
                           std::uint64_t& repeated) {
    const auto value = [&](const Rating& r) -> std::optional<double> {
      const std::optional<double> sum = sumOf(r, keys);
      return sum ? std::optional(*sum / divisor) : std::nullopt;
    };
    return report.agreement.emplace_back(agreementOn(figure, scoresOf(rated, raters, value, repeated))).attempts;
  };
  std::vector<std::string> keys;
  keys.reserve(items.size());
  for (const FormItem& item : items) keys.push_back(item.key);
  const std::uint64_t whole = agreeOn("mean of all items", keys, static_cast<double>(keys.size()), report.repeated);
  report.incomplete = rated.size() - whole - report.repeated;
  if (items.size() == 1) report.agreement.clear();
  std::uint64_t unused = 0;
  for (const FormSubscale& scale : form.subscales) agreeOn(scale.name, scale.items, 1.0, unused);
  for (const FormItem& item : items) agreeOn(item.key, {item.key}, 1.0, unused);
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
                      const std::map<std::string, std::string>& groupOf, const std::vector<std::string>& groups,
                      const Attempts& attemptOf) {
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
    row.groups = summaries({item.key}, groups, taken, groupOf, attemptOf);
    for (const std::string& group : groups) {
      const auto mean = item.published.find(group);
      row.published.push_back(mean == item.published.end() ? std::nullopt : std::optional(mean->second));
    }
    report.items.push_back(std::move(row));
  }
  if (form.ofAttempts) {
    for (const FormSubscale& scale : scalesOf(form))
      report.scales.push_back(
          {scale.name, scale.items.size(), summaries(scale.items, groups, taken, groupOf, attemptOf)});
    addAgreement(report, form, items, taken, attemptOf);
  } else {
    addConsistency(report, form, taken);
  }
  return report;
}

std::vector<FormReport> reportForms(const CohortDatabase& database, const std::map<std::string, std::string>& groupOf,
                                    const std::vector<std::string>& groups, const Attempts& attemptOf) {
  const std::vector<Rating> ratings = database.ratings();
  std::vector<FormReport> reports;
  for (const StoredDocument& stored : database.forms()) {
    const RatingForm form = parseRatingForm(std::as_bytes(std::span(stored.text)), stored.name);
    reports.push_back(reportForm(form, ratings, groupOf, groups, attemptOf));
  }
  return reports;
}

}  // namespace calot::analytics
