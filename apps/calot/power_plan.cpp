// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/power_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "analytics/assessment/protocol.h"
#include "analytics/report/study_protocol.h"
#include "analytics/report/study_tables.h"
#include "apps/calot/environment.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

constexpr std::size_t maxSizes = 100, maxCheckpoints = 200;

std::vector<std::string> split(const std::string& text, char mark) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == mark) {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

/// Of values with this mean and deviation the curve of their logarithms, where they are lognormal.
analytics::NormalCurve curveOf(double mean, double deviation, bool lognormal, const std::string& text) {
  if (!(deviation > 0.0)) failPower(fmt::format("--checkpoint {}: a deviation is not positive", recorder::shown(text)));
  if (!lognormal) return {mean, deviation};
  if (!(mean > 0.0)) failPower(fmt::format("--checkpoint {}: a lognormal mean is positive", recorder::shown(text)));
  const double variance = std::log1p(deviation * deviation / (mean * mean));
  return {std::log(mean) - variance / 2.0, std::sqrt(variance)};
}

/// "elapsed-time:38.9,12,113.3,40": mean and deviation of the first group, then of the second.
void addCheckpoint(PlannedStudy& planned, const std::string& text, bool lognormal) {
  const std::size_t colon = text.rfind(':');
  const std::vector<std::string> words = split(colon == std::string::npos ? text : text.substr(colon + 1), ',');
  std::vector<double> numbers;
  for (const std::string& word : words) {
    std::string fault;
    numbers.push_back(recorder::readFiniteNumber(word, fault));
    if (!fault.empty()) numbers.clear();
    if (!fault.empty()) break;
  }
  if (colon == std::string::npos || colon == 0 || numbers.size() != 4)
    failPower(fmt::format("--checkpoint {}: NAME:MEAN,SD,MEAN,SD is wanted", recorder::shown(text)));
  planned.names.push_back(recorder::shown(text.substr(0, colon)));
  planned.plan.checkpoints.push_back(
      {curveOf(numbers[0], numbers[1], lognormal, text), curveOf(numbers[2], numbers[3], lognormal, text)});
}

/// People of a study at hand and their values of the family's checkpoints.
void drawFrom(PlannedStudy& planned, StudySource& source) {
  const analytics::Study study = studyOf(source);
  std::vector<const analytics::StudyRow*> rows;
  for (const analytics::StudyRow& row : study.rows) {
    const bool inFamily = study.protocol ? row.role == analytics::Role::primary : row.holm.has_value();
    if (inFamily && row.test) rows.push_back(&row);
  }
  if (rows.empty()) throw Error(ErrorKind::refused, fmt::format("{}: no figure has a test to plan for", study.where));
  analytics::PowerPopulation& population = planned.plan.population.emplace();
  std::array<std::map<std::string, std::vector<std::optional<double>>>, 2> people;
  for (std::size_t c = 0; c < rows.size(); ++c) {
    planned.names.push_back(analytics::rowName(*rows[c]));
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t i = 0; i < rows[c]->values[g].size(); ++i) {
        auto& person = people[g][rows[c]->participants[g][i]];
        person.resize(rows.size());
        person[c] = rows[c]->values[g][i];
      }
    }
  }
  for (std::size_t g = 0; g < 2; ++g) {
    for (auto& item : people[g]) population.people[g].push_back(std::move(item.second));
  }
  planned.groups = study.groups;
  planned.synthetic = study.synthetic;
  planned.origin = fmt::format(
      "drawn with replacement from {} {} and {} {} of {}: what was measured on few people is a "
      "guess of the truth, and power from it is optimistic where the effect was found large",
      population.people[0].size(), study.groups[0], population.people[1].size(), study.groups[1], study.where);
}

/// Effects on the protocol's primary hypotheses, without anybody's data: one for all, or one each.
void planByProtocol(PlannedStudy& planned, PowerOptions& o) {
  const analytics::Protocol protocol = analytics::readProtocol(findAsset(o.source.protocol, "protocols", "protocol"));
  for (const analytics::DirectedHypothesis& h : protocol.hypotheses) {
    if (h.primary) planned.names.push_back(analytics::figureOf(h));
  }
  if (o.effects.size() == 1) o.effects.resize(planned.names.size(), o.effects.front());
  if (!o.checkpoints.empty() || o.effects.size() != planned.names.size())
    failPower(fmt::format("protocol {} has {} primary hypotheses: --effect wants one number for all, or {}",
                          protocol.name, planned.names.size(), planned.names.size()));
  planned.plan.checkpoints = analytics::shifts(o.effects);
  planned.groups = {protocol.populations[0].group, protocol.populations[1].group};
  planned.origin =
      fmt::format("{} groups, primary hypotheses of protocol {} version {}", o.shape, protocol.name, protocol.version);
  o.level = protocol.level;
}

}  // namespace

void failPower(const std::string& what) { throw Error(ErrorKind::invalid, "power: " + what); }

std::vector<std::size_t> sizesOf(const std::string& text) {
  const auto number = [&](const std::string& word) {
    std::string fault;
    const long long n = recorder::readWholeNumber(word, fault);
    if (!fault.empty() || n < 2 || n > static_cast<long long>(maxPeople))
      failPower(fmt::format("--n {}: FROM:TO:STEP, a list A,B,C or one number, from 2 to {}", recorder::shown(text),
                            maxPeople));
    return static_cast<std::size_t>(n);
  };
  std::vector<std::size_t> sizes;
  if (text.find(':') == std::string::npos) {
    for (const std::string& word : split(text, ',')) sizes.push_back(number(word));
  } else {
    const std::vector<std::string> parts = split(text, ':');
    if (parts.size() > 3) failPower(fmt::format("--n {}: FROM:TO:STEP", recorder::shown(text)));
    std::string fault;
    const long long by = parts.size() < 3 ? 1 : recorder::readWholeNumber(parts[2], fault);
    if (!fault.empty() || by < 1) failPower(fmt::format("--n {}: the step is no number from 1", recorder::shown(text)));
    const std::size_t from = number(parts[0]), to = number(parts[1]);
    for (std::size_t n = from; n <= to; n += static_cast<std::size_t>(by)) sizes.push_back(n);
  }
  if (sizes.empty() || sizes.size() > maxSizes)
    failPower(fmt::format("--n {}: {} sizes; from 1 to {} are allowed", recorder::shown(text), sizes.size(), maxSizes));
  return sizes;
}

PlannedStudy planOf(PowerOptions& o) {
  PlannedStudy planned;
  planned.plan.checkpoints.clear();
  const bool data = !o.source.database.empty() || !o.source.table.empty();
  const int ways = (data ? 1 : 0) + (o.effects.empty() ? 0 : 1) + (o.checkpoints.empty() ? 0 : 1);
  if (ways != 1) failPower("say what the groups are like by one of --effect, --checkpoint, a cohort or --table");
  const bool lognormal = o.shape == "lognormal";
  if (o.effects.size() + o.checkpoints.size() > maxCheckpoints)
    failPower(fmt::format("more than {} checkpoints", maxCheckpoints));
  if (data) {
    drawFrom(planned, o.source);
    if (!o.source.protocol.empty()) {
      const analytics::Protocol protocol =
          analytics::readProtocol(findAsset(o.source.protocol, "protocols", "protocol"));
      o.level = protocol.level;
      planned.family = static_cast<std::size_t>(std::count_if(protocol.hypotheses.begin(), protocol.hypotheses.end(),
                                                              [](const auto& h) { return h.primary; }));
    }
  } else if (!o.source.protocol.empty()) {
    planByProtocol(planned, o);
  } else {
    planned.origin = fmt::format("{} groups", o.shape);
    planned.plan.checkpoints = analytics::shifts(o.effects);
    for (const double effect : o.effects) planned.names.push_back(fmt::format("shift {} sd", effect));
    for (const std::string& text : o.checkpoints) addCheckpoint(planned, text, lognormal);
  }
  if (planned.family == 0) planned.family = planned.names.size();
  planned.plan.shape = lognormal ? analytics::PowerShape::lognormal : analytics::PowerShape::normal;
  planned.plan.correlation = o.correlation;
  planned.plan.step = o.step;
  planned.plan.level = o.level;
  planned.plan.adjustment = o.adjustment == "holm"   ? analytics::Adjustment::holm
                            : o.adjustment == "none" ? analytics::Adjustment::none
                                                     : analytics::Adjustment::benjaminiHochberg;
  // Draws from people have ties, whose exact distribution is counted anew each time.
  planned.plan.simulations = o.simulations > 0 ? o.simulations : data ? 2000 : 10000;
  planned.plan.seed = std::stoull(o.seed);
  return planned;
}

}  // namespace calot::apps
