// SPDX-License-Identifier: GPL-3.0-or-later
// Members of a norm, who of them is competent, and their values.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "analytics/assessment/norm.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/study_rows.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

constexpr const char* competentGroup = "competent";
constexpr const char* otherGroup = "not competent";
constexpr const char* borderlinePrefix = "borderline regression on form ";
constexpr const char* borderlineMark = ", borderline mark ";

/// The attempts with a group by their score, `above` from the mark on; of a participant the first that has a score.
/// Others have no group.
std::vector<AttemptRow> groupedBy(std::vector<AttemptRow> attempts, const std::map<std::string, double>& scores,
                                  double mark, const char* above, const char* below) {
  std::set<std::string> seen;
  for (AttemptRow& a : attempts) {  // by start
    const auto at = scores.find(a.uuid);
    a.group.clear();
    if (at == scores.end() || (!a.participant.empty() && !seen.insert(a.participant).second)) continue;
    a.group = at->second >= mark ? above : below;
  }
  return attempts;
}

/// The attempts with a group by what most of their raters say.
std::vector<AttemptRow> judged(const std::vector<AttemptRow>& attempts, const std::vector<Rating>& ratings,
                               const std::string& form, const std::string& name) {
  std::map<std::string, double> votes;  // for competent, less those against
  for (const Rating& r : ratings) {
    const auto at = r.answers.find(competenceItem);
    if (r.form == form && at != r.answers.end()) votes[r.attempt] += at->second > 0 ? 1.0 : -1.0;
  }
  if (votes.empty())
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("no attempt was rated with form {} and its item \"{}\"", form, competenceItem),
                {Remedy::rateAttempts});
  std::erase_if(votes, [](const auto& vote) { return vote.second == 0.0; });  // divided
  return groupedBy(attempts, votes, 0.0, competentGroup, otherGroup);
}

/// A figure of the norm: a checkpoint or an external metric, and its subject. The definition is that of a value.
struct NormFigure {
  const CheckpointDefinition* definition = nullptr;
  std::string subject;
  ExternalMetricRef metric;
};

/// True if a figure belongs to the norm; figures of phases, which repeat the whole attempt's, only on request.
bool isAskedFor(const CheckpointDefinition& definition, const std::string& subject, const NormRequest& request) {
  const bool named = std::any_of(request.checkpoints.begin(), request.checkpoints.end(),
                                 [&](const std::string& wanted) { return isCalled(wanted, definition.name, subject); });
  return !isOfPhases(definition) || request.who.includePhases || named;
}

/// Figures of the members that judge, in the registry's order; one value per member.
std::vector<NormFigure> collectValues(Norm& norm, const std::vector<AttemptValue>& values, const NormRequest& request,
                                      const std::string& name) {
  std::vector<NormFigure> figures;
  std::map<std::string, NormMember*> member;
  for (NormMember& m : norm.members) member[m.attempt] = &m;
  for (const AttemptValue& item : values) {
    const auto whose = member.find(item.attempt);
    const CheckpointDefinition* definition = definitionOf(item.value);
    if (whose == member.end() || definition == nullptr || definition->direction == Direction::none) continue;
    if (!item.value.value || !std::isfinite(*item.value.value)) continue;
    if (!isAskedFor(*definition, item.value.subject, request)) continue;
    if (item.value.version != definition->version)
      throw Error(ErrorKind::refused, Where{name},
                  fmt::format("attempt {} has {} of version {}, this program computes {}; assess its recording again",
                              item.attempt, definition->name, item.value.version, definition->version));
    const auto known = std::find_if(figures.begin(), figures.end(), [&](const NormFigure& f) {
      return f.definition->name == definition->name && f.subject == item.value.subject;
    });
    if (known != figures.end() && known->definition->version != definition->version)
      throw Error(ErrorKind::refused, Where{name},
                  fmt::format("members have {} of versions {} and {}; run its newest script over all recordings",
                              definition->name, known->definition->version, definition->version));
    const auto position = static_cast<std::size_t>(known - figures.begin());
    if (position == figures.size()) {
      figures.push_back({definition, item.value.subject, item.value.metric});
      for (NormMember& m : norm.members) m.values.emplace_back();
    }
    whose->second->values[position] = withoutDust(item.value, definition->displayFactor);
  }
  return figures;
}

/// makeStudy(), whose advice is cut to what a norm can take: of several attempts the first, never their mean.
Study studyOfMembers(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                     const StudyOptions& who, const std::string& name) {
  try {
    return makeStudy(attempts, values, who, name);
  } catch (const Error& e) {
    std::vector<Remedy> remedies;
    for (const Remedy remedy : e.remedies()) {
      if (remedy == Remedy::takeMean || remedy == Remedy::mixKeys) continue;
      remedies.push_back(remedy == Remedy::chooseAttemptRule ? Remedy::takeFirst : remedy);
    }
    throw Error(e.kind(), e.where(), e.fault(), std::move(remedies));
  }
}

}  // namespace

Norm gatherNorm(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                const std::vector<Rating>& ratings, const NormRequest& request, const std::string& name) {
  if (request.who.protocol && request.who.protocol->protocol.attemptRule == AttemptRule::mean)
    throw Error(ErrorKind::refused, Where{request.who.protocol->protocol.file},
                "its attempt rule is the mean, and a mean of attempts is not an attempt that others are held against");
  if (request.who.attemptRule == AttemptRule::mean)
    throw Error(ErrorKind::invalid, "norm: a mean of attempts is not an attempt", {Remedy::takeFirst});
  StudyOptions who = request.who;
  std::vector<AttemptRow> candidates = attempts;
  Norm norm;
  if (!request.judgedBy.empty()) {
    candidates = judged(attempts, ratings, request.judgedBy, name);
    who.groups = {competentGroup, otherGroup};
    who.better = competentGroup;
    norm.judgedBy = fmt::format("form {}, majority of raters", request.judgedBy);
  }
  if (request.borderline) {
    candidates = groupedByRating(attempts, meanRatings(ratings, request.borderline->form), *request.borderline, name);
    who.groups = {atMarkGroup, belowMarkGroup};
    who.better = atMarkGroup;
    norm.judgedBy =
        borderlinePrefix + request.borderline->form + borderlineMark + fmt::format("{}", request.borderline->mark);
  }
  const Study study = studyOfMembers(candidates, values, who, name);
  if (study.better.empty())
    throw Error(ErrorKind::invalid,
                fmt::format("norm: which of {} and {} is competent is not said", study.groups[0], study.groups[1]),
                {Remedy::nameBetterGroup});
  if (norm.judgedBy.empty()) {
    norm.judgedBy = fmt::format("{} {} against {}", who.grouping == Grouping::group ? "group" : "performers",
                                study.better, study.better == study.groups[0] ? study.groups[1] : study.groups[0]);
  }
  norm.name = request.name;
  norm.by = request.by;
  norm.seed = request.seed;
  norm.synthetic = study.synthetic;
  if (study.keys.size() != 1)
    throw Error(ErrorKind::refused, Where{name}, "a norm needs attempts of one comparability key", {Remedy::chooseKey});
  norm.comparabilityKey = study.keys[0];
  for (const AttemptRow& a : candidates) {
    const auto group = study.groupOf.find(a.uuid);
    if (group != study.groupOf.end()) norm.members.push_back({a.uuid, group->second == study.better, {}});
  }
  const std::vector<NormFigure> figures = collectValues(norm, values, request, name);
  for (const StudyRow& row : study.rows) {
    const CoverageRow* sampling = coverageOf(study, row);
    if (sampling == nullptr || sampling->refusal.empty()) continue;
    if (std::any_of(figures.begin(), figures.end(), [&](const NormFigure& f) {
          return f.definition->name == row.checkpoint && f.subject == row.subject;
        }))
      throw Error(ErrorKind::refused, Where{name}, fmt::format("{}: {}", row.checkpoint, sampling->refusal));
  }
  for (const NormFigure& figure : figures)
    norm.checkpoints.push_back({figure.definition->name,
                                figure.subject,
                                figure.definition->version,
                                figure.definition->direction,
                                false,
                                false,
                                {},
                                {},
                                {},
                                "",
                                figure.metric});
  return norm;
}

void decideMembers(Norm& norm, const NormRequest& request) {
  const std::size_t all = norm.members.size();
  std::size_t changed = 0;
  std::vector<NormMember> members;
  for (NormMember& member : norm.members) {
    const auto at = request.decided.find(member.attempt);
    if (at != request.decided.end() && at->second != member.competent) {
      ++changed;
      if (!at->second) continue;
      member.competent = *at->second;
    }
    members.push_back(std::move(member));
  }
  norm.members = std::move(members);
  if (changed > 0) norm.judgedBy += fmt::format("; {} of {} decided by {}", changed, all, request.by);
}

bool isByBorderline(const Norm& norm) { return norm.judgedBy.rfind(borderlinePrefix, 0) == 0; }

std::optional<BorderlineMark> borderlineOf(const Norm& norm) {
  const std::size_t at = norm.judgedBy.rfind(borderlineMark), begin = std::string_view(borderlinePrefix).size();
  if (!isByBorderline(norm) || at == std::string::npos) return std::nullopt;
  std::string fault;
  const double mark =
      recorder::readFiniteNumber(norm.judgedBy.substr(at + std::string_view(borderlineMark).size()), fault);
  return BorderlineMark{norm.judgedBy.substr(begin, at - begin), mark};
}

std::map<std::string, double> meanRatings(const std::vector<Rating>& ratings, const std::string& form) {
  std::map<std::string, std::pair<double, double>> sums;  // of raters' means, and their number
  for (const Rating& r : ratings) {
    if (r.form != form || r.attempt.empty() || r.answers.empty()) continue;
    double sum = 0.0;
    for (const auto& item : r.answers) sum += item.second;
    auto& [total, raters] = sums[r.attempt];
    total += sum / static_cast<double>(r.answers.size());
    raters += 1.0;
  }
  std::map<std::string, double> means;
  for (const auto& [attempt, sum] : sums) means[attempt] = sum.first / sum.second;
  return means;
}

std::vector<AttemptRow> groupedByRating(std::vector<AttemptRow> attempts, const std::map<std::string, double>& ratings,
                                        const BorderlineMark& borderline, const std::string& name) {
  if (ratings.empty())
    throw Error(ErrorKind::refused, Where{name}, fmt::format("no attempt was rated with form {}", borderline.form),
                {Remedy::rateAttempts});
  return groupedBy(std::move(attempts), ratings, borderline.mark, atMarkGroup, belowMarkGroup);
}

}  // namespace calot::analytics
