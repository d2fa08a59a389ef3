// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/assessment/norm.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "analytics/assessment/verdict.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/report/report_document.h"
#include "analytics/report/study_rows.h"
#include "analytics/statistics/standard_setting.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

constexpr const char* competentGroup = "competent";
constexpr const char* otherGroup = "not competent";
constexpr const char* allFigures = "all";
constexpr const char* borderlinePrefix = "borderline regression on form ";
constexpr const char* borderlineMark = ", borderline mark ";

std::size_t competentMembers(const Norm& norm) {
  return static_cast<std::size_t>(
      std::count_if(norm.members.begin(), norm.members.end(), [](const NormMember& m) { return m.competent; }));
}

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

bool isNamed(const std::vector<std::string>& named, const std::string& checkpoint, const std::string& subject) {
  return std::any_of(named.begin(), named.end(),
                     [&](const std::string& wanted) { return isCalled(wanted, checkpoint, subject); });
}

/// In the place of a pass mark. The norm keeps by which version of the rules its members were judged.
constexpr const char* criticalMark = "one fails an attempt, whatever its other figures";

NormCheckpoint markOf(const CheckpointDefinition& definition, const NormFigure& figure, const Norm& norm,
                      std::size_t position, const std::map<std::string, double>& ratings,
                      const std::optional<BorderlineMark>& borderline) {
  NormCheckpoint mark{
      definition.name, figure.subject, definition.version, definition.direction, false, false, {}, {}, {}, "",
      figure.metric};
  if (definition.name == criticalErrors) {
    mark.reason = criticalMark;
    return mark;
  }
  std::vector<double> competent, others, rated, all;
  bool positive = true;
  for (const NormMember& m : norm.members) {
    if (!m.values[position]) continue;
    (m.competent ? competent : others).push_back(*m.values[position]);
    all.push_back(*m.values[position]);
    if (borderline) rated.push_back(ratings.at(m.attempt));
    positive = positive && *m.values[position] > 0.0;
  }
  mark.logScale = definition.unit == "s" && positive;
  if (borderline) {
    const Expected<RegressionCut> cut =
        borderlineCut(rated, all, borderline->mark, definition.direction, mark.logScale);
    mark.reason = cut.reason();
    if (!cut) return mark;
    mark.cut = cut->cut;
    mark.lower = cut->lower;
    mark.upper = cut->upper;
    return mark;
  }
  const ContrastingGroupsOptions options{{.seed = norm.seed}, mark.logScale};
  const Expected<ContrastingGroups> cut = contrastingGroups(
      competent, others, definition.direction == Direction::lower ? Better::lower : Better::higher, options);
  if (!cut) {
    mark.reason = cut.reason();
    return mark;
  }
  mark.cut = cut->cut;
  if (cut->interval) {
    mark.lower = cut->interval->lower;
    mark.upper = cut->interval->upper;
  } else {
    mark.reason = "no interval: " + cut->interval.reason();
  }
  return mark;
}

/// True if a figure belongs to the norm; figures of phases, which repeat the whole attempt's, only on request.
bool isAskedFor(const CheckpointDefinition& definition, const std::string& subject, const NormRequest& request) {
  return !isOfPhases(definition) || request.who.includePhases || isNamed(request.checkpoints, definition.name, subject);
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

/// True if a figure can be in the rule, given a mark.
bool isCandidate(const std::string& checkpoint, const std::string& subject, const NormRequest& request) {
  const auto fixed = [&](const FixedCut& cut) { return isCalled(cut.figure, checkpoint, subject); };
  if (std::any_of(request.fixed.begin(), request.fixed.end(), fixed)) return true;
  if (request.checkpoints.empty()) return countsByDefault(checkpoint);
  return request.checkpoints.front() == allFigures || isNamed(request.checkpoints, checkpoint, subject);
}

/// Before any mark is made: a rule that asks for more figures than there can be in it.
void checkCount(const std::vector<NormFigure>& figures, const NormRequest& request, const std::string& name) {
  const auto candidates =
      static_cast<std::size_t>(std::count_if(figures.begin(), figures.end(), [&](const NormFigure& f) {
        return isCandidate(f.definition->name, f.subject, request);
      }));
  if (candidates > 0 && request.leastPassed > candidates)  // of none, declareRule() says which names are unknown
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("the rule asks for {} figures, {}", request.leastPassed,
                            request.checkpoints.empty()
                                ? fmt::format("and of those that count the members have {}", candidates)
                                : fmt::format("and the checkpoints that are named give {}", candidates)));
}

void declareRule(Norm& norm, const NormRequest& request, const std::string& name) {
  setFixedCuts(norm, request.fixed);
  const bool all = !request.checkpoints.empty() && request.checkpoints.front() == allFigures;
  for (NormCheckpoint& mark : norm.checkpoints) {
    if (mark.inRule || !mark.cut) continue;
    mark.inRule = all || (request.checkpoints.empty() && countsByDefault(mark.checkpoint));
  }
  for (const std::string& wanted : request.checkpoints) {
    if (all) break;
    bool found = false;
    for (NormCheckpoint& mark : norm.checkpoints) {
      if (!isCalled(wanted, mark.checkpoint, mark.subject)) continue;
      found = true;
      if (!mark.cut)
        throw Error(ErrorKind::refused, Where{name},
                    fmt::format("{} has no pass mark: {}", figureName(mark.checkpoint, mark.subject), mark.reason));
      mark.inRule = true;
    }
    if (!found)
      throw Error(ErrorKind::invalid, fmt::format("norm: the members have no figure \"{}\" that judges", wanted),
                  {Remedy::nameCheckpoints});
  }
  const std::size_t inRule = figuresInRule(norm);
  if (inRule == 0)
    throw Error(ErrorKind::refused, Where{name}, "no figure that counts has a pass mark", {Remedy::nameCheckpoints});
  norm.leastPassed = request.leastPassed;
  if (norm.leastPassed > inRule)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("the rule asks for {} figures, and {} of {} have a pass mark", norm.leastPassed, inRule,
                            norm.checkpoints.size()));
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

Norm makeNorm(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
              const std::vector<Rating>& ratings, const NormRequest& request, const std::string& name) {
  constexpr const char* plain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_.";
  if (request.name.empty() || request.name.size() > maxName ||
      request.name.find_first_not_of(plain) != std::string::npos)
    throw Error(ErrorKind::invalid,
                "norm: a name has 1 to 64 letters, digits, points, hyphens and underscores, and no others");
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
  std::map<std::string, double> rating;
  if (request.borderline) {
    rating = meanRatings(ratings, request.borderline->form);
    candidates = groupedByRating(attempts, rating, *request.borderline, name);
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
  norm.membersMade = norm.members.size();
  const std::size_t competent = competentMembers(norm);
  if (std::min(competent, norm.members.size() - competent) < minNormMembers)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("a norm wants at least {} competent members and as many others; there are {} and {}",
                            minNormMembers, competent, norm.members.size() - competent));
  const auto figures = collectValues(norm, values, request, name);
  for (const StudyRow& row : study.rows) {
    const CoverageRow* sampling = coverageOf(study, row);
    if (sampling == nullptr || sampling->refusal.empty()) continue;
    if (std::any_of(figures.begin(), figures.end(), [&](const NormFigure& f) {
          return f.definition->name == row.checkpoint && f.subject == row.subject;
        }))
      throw Error(ErrorKind::refused, Where{name}, fmt::format("{}: {}", row.checkpoint, sampling->refusal));
  }
  checkCount(figures, request, name);
  for (std::size_t i = 0; i < figures.size(); ++i)
    norm.checkpoints.push_back(markOf(*figures[i].definition, figures[i], norm, i, rating, request.borderline));
  declareRule(norm, request, name);
  return norm;
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

bool passes(const NormCheckpoint& mark, double value) {
  return mark.direction == Direction::lower ? value <= *mark.cut : value >= *mark.cut;
}

std::size_t figuresInRule(const Norm& norm) {
  return static_cast<std::size_t>(
      std::count_if(norm.checkpoints.begin(), norm.checkpoints.end(), [](const auto& c) { return c.inRule; }));
}

std::size_t neededPasses(const Norm& norm) { return norm.leastPassed > 0 ? norm.leastPassed : figuresInRule(norm); }

std::string ruleText(const Norm& norm) {
  const auto [competent, others] = passRates(norm);
  return fmt::format(
      "no critical error, and {} of {} figures passed. By this rule {} of {} competent members pass, and {} of {} "
      "others. The pass marks come from these same members, so people new to the norm will be judged correctly less "
      "often.",
      neededPasses(norm), figuresInRule(norm), competent.passed, competent.members, others.passed, others.members);
}

std::string passMarkWarning(const Norm& norm) {
  if (std::none_of(norm.checkpoints.begin(), norm.checkpoints.end(), [](const auto& c) { return c.lower; })) return {};
  const std::size_t competent = competentMembers(norm);
  const std::string text =
      isByBorderline(norm)
          ? coverageWarning(CoveredInterval::borderline, "pass mark", norm.members.size(), norm.members.size(),
                            "rated attempts")
          : coverageWarning(CoveredInterval::cut, "pass mark", competent, norm.members.size() - competent);
  return text.empty() ? text : "Warning: " + text + ".";
}

std::string ownFailureWarning(const Norm& norm) {
  const auto [competent, others] = passRates(norm);
  if (competent.passed == competent.members) return {};
  const std::uint64_t failed = competent.members - competent.passed;
  return fmt::format("Warning: {} of the {} competent members {} by the norm's own rule.", failed, competent.members,
                     failed == 1 ? "fails" : "fail");
}

namespace {

bool hasCriticalError(const Norm& norm, const NormMember& member) {
  for (std::size_t c = 0; c < norm.checkpoints.size(); ++c) {
    if (norm.checkpoints[c].checkpoint == criticalErrors) return member.values[c].value_or(0.0) > 0.0;
  }
  return false;
}

}  // namespace

std::pair<PassRate, PassRate> passRates(const Norm& norm) {
  std::pair<PassRate, PassRate> rates;
  for (const NormMember& m : norm.members) {
    std::vector<bool> passed;
    for (std::size_t c = 0; c < norm.checkpoints.size(); ++c)
      passed.push_back(norm.checkpoints[c].cut && m.values[c] && passes(norm.checkpoints[c], *m.values[c]));
    PassRate& rate = m.competent ? rates.first : rates.second;
    ++rate.members;
    if (!hasCriticalError(norm, m) && keepsRule(norm, passed)) ++rate.passed;
  }
  return rates;
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

Expected<RegressionCut> borderlineCut(const std::vector<double>& ratings, const std::vector<double>& values,
                                      double mark, Direction direction, bool logScale) {
  std::vector<double> scores;
  scores.reserve(values.size());
  for (const double v : values) scores.push_back(logScale ? std::log(v) : v);
  const Expected<BorderlineRegression> line =
      borderlineRegression(ratings, scores, mark, direction == Direction::lower ? Better::lower : Better::higher);
  if (!line) return NoResult{line.reason()};
  const auto back = [logScale](double v) { return logScale ? std::exp(v) : v; };
  return RegressionCut{back(line->cut), back(line->interval.lower), back(line->interval.upper)};
}

}  // namespace calot::analytics
