// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage, rate and noise of the trackers behind a study's figures of motion.

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "analytics/checkpoints/motion.h"
#include "analytics/report/report_document.h"
#include "analytics/report/study_rows.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/rank_tests.h"

namespace calot::analytics {
namespace {

std::string percent(double share) { return fmt::format("{:.1f}", 100.0 * share); }

std::string subjectName(const std::string& subject) {
  if (subject.empty()) return "both hands";
  return subject.find(' ') == std::string::npos ? subject + " hand" : subject;  // "left clipping"
}

double lowest(const std::vector<double>& shares) { return *std::min_element(shares.begin(), shares.end()); }

bool isWhole(const CoverageRow& row) {
  return std::all_of(row.share.begin(), row.share.end(),
                     [](const std::vector<double>& g) { return g.empty() || lowest(g) == 1.0; });
}

/// Coverage of a subject for which the study has a figure.
bool isShown(const Study& study, const CoverageRow& row) {
  return std::any_of(study.rows.begin(), study.rows.end(),
                     [&](const StudyRow& r) { return coverageOf(study, r) == &row; });
}

}  // namespace

void CoverageCollector::add(const CheckpointValue& value, std::size_t group, const std::string& participant,
                            const std::string& attempt) {
  if (!value.coverage) return;
  auto at = std::find_if(subjects_.begin(), subjects_.end(), [&](const Subject& s) { return s.name == value.subject; });
  if (at == subjects_.end()) at = subjects_.insert(at, Subject{value.subject, {}, {}});
  at->sampled[group][participant].try_emplace(attempt, std::array{value.coverage, value.rate, value.noise});
  at->below[group][participant] |= value.availability == Availability::tooLittleCoverage;
}

std::vector<CoverageRow> CoverageCollector::rows() const {
  std::vector<CoverageRow> rows;
  for (const Subject& subject : subjects_) {
    CoverageRow& row = rows.emplace_back();
    row.subject = subject.name;
    for (std::size_t g = 0; g < 2; ++g) {
      std::array<std::vector<double>*, 3> values{&row.share[g], &row.rate.values[g], &row.noise.values[g]};
      for (const auto& [person, attempts] : subject.sampled[g]) {
        for (std::size_t q = 0; q < values.size(); ++q) {
          double sum = 0.0, count = 0.0;
          for (const auto& item : attempts) {
            sum += item.second[q].value_or(0.0);
            count += item.second[q] ? 1.0 : 0.0;
          }
          if (count > 0.0) values[q]->push_back(sum / count);
        }
      }
      row.below[g] = static_cast<std::uint64_t>(std::count_if(subject.below[g].begin(), subject.below[g].end(),
                                                              [](const auto& item) { return item.second; }));
    }
    row.test = mannWhitney(row.share[0], row.share[1]);
    for (TrackerQuality* quality : {&row.rate, &row.noise}) {
      std::array<std::vector<double>, 2> relevant = quality->values;
      for (std::vector<double>& values : relevant) {
        // To 1 Hz and 0.01 mm: a rank test would find differences of rounding.
        for (double& v : values)
          v = quality == &row.rate ? std::round(std::min(v, motionRate)) : std::round(1e5 * std::max(v, minNoise));
      }
      quality->test = mannWhitney(relevant[0], relevant[1]);
    }
  }
  return rows;
}

const CoverageRow* coverageOf(const Study& study, const StudyRow& row) {
  if (!row.sampled) return nullptr;
  const auto at = std::find_if(study.coverage.begin(), study.coverage.end(),
                               [&](const CoverageRow& c) { return c.subject == row.subject; });
  return at == study.coverage.end() ? nullptr : &*at;
}

bool coverageDiffers(const CoverageRow& row, double level) { return row.test && row.test->p <= level; }

namespace {

std::string qualityText(const TrackerQuality& quality, std::size_t group, const char* unit, double factor = 1.0) {
  const Expected<double> middle = median(quality.values[group]);
  return middle ? fmt::format("{:.{}f}{}", factor * *middle, factor > 1.0 ? 3 : 1, unit) : "-";
}

std::string rateText(const CoverageRow& row, std::size_t group) { return qualityText(row.rate, group, " Hz"); }
std::string noiseText(const CoverageRow& row, std::size_t group) {
  return qualityText(row.noise, group, " mm", 1000.0);
}

/// The greater of both groups' medians by the smaller; 1 where one is not known.
double ratioOf(const TrackerQuality& quality, double least, double most) {
  const Expected<double> a = median(quality.values[0]), b = median(quality.values[1]);
  if (!a || !b) return 1.0;
  const double x = std::clamp(*a, least, most), y = std::clamp(*b, least, most);
  return std::max(x, y) / std::min(x, y);
}

}  // namespace

std::string trackersApart(const Study& study, const CoverageRow& row) {
  const bool rate = ratioOf(row.rate, 1.0, motionRate) > maxRateRatio;
  if (!rate && ratioOf(row.noise, minNoise, 1.0) <= maxNoiseRatio) return {};
  const auto text = [&](std::size_t g) { return rate ? rateText(row, g) : noiseText(row, g); };
  return fmt::format("the trackers are not alike: median {} {} in {}, {} in {}", rate ? "rate" : "noise", text(0),
                     study.groups[0], text(1), study.groups[1]);
}

void TrackerSpread::add(const CheckpointValue& value) {
  const auto widen = [](std::array<std::optional<double>, 2>& range, const std::optional<double>& v) {
    if (v) range = {std::min(range[0].value_or(*v), *v), std::max(range[1].value_or(*v), *v)};
  };
  widen(rate_, value.rate);
  widen(noise_, value.noise);
}

std::string TrackerSpread::warning() const {
  const auto differs = [](const std::array<std::optional<double>, 2>& range, double least, double most, double ratio) {
    return range[0] && std::clamp(*range[1], least, most) > ratio * std::clamp(*range[0], least, most);
  };
  if (!differs(rate_, 1.0, motionRate, maxRateRatio) && !differs(noise_, minNoise, 1.0, maxNoiseRatio)) return {};
  return fmt::format(
      "Warning: the trackers differ between attempts: rates from {:.1f} to {:.1f} Hz, noise from {:.3f} to {:.3f} mm. "
      "Differences in figures of motion may be ones of measurement, not of skill.",
      rate_[0].value_or(0.0), rate_[1].value_or(0.0), 1000.0 * noise_[0].value_or(0.0),
      1000.0 * noise_[1].value_or(0.0));
}

bool samplingDiffers(const Study& study, const CoverageRow& row, double level) {
  const auto differs = [&](const Expected<MannWhitney>& test) { return test && test->p <= level; };
  return differs(row.test) || differs(row.rate.test) || differs(row.noise.test) || !trackersApart(study, row).empty();
}

ReportTable coverageTable(const Study& study) {
  ReportTable table =
      tableOf("Coverage", {"=samples of", "=group", "n", "median %", "lowest %", "too little", "p", "rate", "noise"});
  for (const CoverageRow& row : study.coverage) {
    if ((isWhole(row) && !samplingDiffers(study, row)) || !isShown(study, row)) continue;
    for (std::size_t g = 0; g < 2; ++g) {
      const std::vector<double>& shares = row.share[g];
      table.rows.push_back({g == 0 ? subjectName(row.subject) : "", study.groups[g], fmt::format("{}", shares.size()),
                            shares.empty() ? "-" : percent(*median(shares)),
                            shares.empty() ? "-" : percent(lowest(shares)),
                            row.below[g] == 0 ? "" : fmt::format("{}", row.below[g]),
                            g > 0      ? ""
                            : row.test ? pText(row.test->p)
                                       : "-",
                            rateText(row, g), noiseText(row, g)});
    }
  }
  return table;
}

std::string coverageNote(const Study& study) {
  if (study.coverage.empty()) return {};
  if (coverageTable(study).rows.empty()) return "Coverage: samples cover the whole of every attempt.";
  return "Coverage: share of the time with an instrument that the tracker's samples cover, one value per participant. "
         "too little: participants with a figure that was refused for it. p: Mann-Whitney, two-sided, not adjusted. "
         "rate, noise: medians of the trackers' samples a second, and of their positions' deviation on each axis.";
}

std::vector<std::string> coverageWarnings(const Study& study) {
  std::vector<std::string> notes;
  for (const CoverageRow& row : study.coverage) {
    if (!samplingDiffers(study, row) || !isShown(study, row)) continue;
    if (!coverageDiffers(row)) {
      notes.push_back(
          fmt::format("Warning: the trackers differ ({}): median rate {} and noise {} in {}, {} and {} in {}. {}",
                      subjectName(row.subject), rateText(row, 0), noiseText(row, 0), study.groups[0], rateText(row, 1),
                      noiseText(row, 1), study.groups[1],
                      row.refusal.empty()
                          ? "A difference between the groups in its figures may be one of measurement, not of skill."
                          : "Its figures are not tested."));
      continue;
    }
    notes.push_back(fmt::format(
        "Warning: coverage differs ({}): a median of {} % in {}, {} % in {} (p {}). A difference between the "
        "groups in its figures may be one of measurement, not of skill.",
        subjectName(row.subject), percent(*median(row.share[0])), study.groups[0], percent(*median(row.share[1])),
        study.groups[1], pText(row.test->p)));
  }
  return notes;
}

}  // namespace calot::analytics
