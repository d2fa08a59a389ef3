// SPDX-License-Identifier: GPL-3.0-or-later
// calot power: how many people a study needs, by simulating the study itself.
#include <algorithm>
#include <cmath>
#include <map>

#include "analytics/assessment/protocol.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_protocol.h"
#include "analytics/statistics/power.h"
#include "analytics/statistics/two_groups.h"
#include "apps/calot/command.h"
#include "apps/calot/study_command.h"
#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

constexpr std::size_t maxPeople = 500;  ///< in a group

/// Options of the command line.
struct PowerOptions {
  StudySource source;
  std::vector<std::string> checkpoints;
  std::vector<double> effects;
  std::string sizes = "5:30:5", shape = "normal", adjustment = "holm", seed = "1";
  double allocation = 1.0, correlation = 0.0, step = 0.0, level = 0.05, target = 0.8;
  std::uint64_t simulations = 0;
  bool json = false;
};

/// A study to be planned, without its sizes.
struct PlannedStudy {
  analytics::PowerPlan plan;
  std::vector<std::string> names;  ///< of its checkpoints
  /// Tests in the family of Holm's adjustment: a protocol's primary hypotheses, those without a test too; else names.
  std::size_t family = 0;
  std::array<std::string, 2> groups{"first group", "second group"};
  std::string origin;  ///< where the distributions are from, a sentence
  bool synthetic = false;
};

constexpr std::size_t maxSizes = 100, maxCheckpoints = 200;

[[noreturn]] void failPower(const std::string& what) { throw Error(ErrorKind::invalid, "power: " + what); }

std::vector<std::string> split(const std::string& text, char mark) {
  std::vector<std::string> parts;
  std::istringstream in(text + mark);
  for (std::string part; std::getline(in, part, mark);) parts.push_back(part);
  return parts;
}

/// Curve of values with this mean and deviation; of their logarithms if they are lognormal.
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
  numbers.reserve(words.size());
  std::string fault;
  for (const std::string& word : words) numbers.push_back(recorder::readFiniteNumber(word, fault));
  if (colon == std::string::npos || colon == 0 || !fault.empty() || numbers.size() != 4)
    failPower(fmt::format("--checkpoint {}: NAME:MEAN,SD,MEAN,SD is expected", recorder::shown(text)));
  planned.names.push_back(recorder::shown(text.substr(0, colon)));
  planned.plan.checkpoints.push_back(
      {curveOf(numbers[0], numbers[1], lognormal, text), curveOf(numbers[2], numbers[3], lognormal, text)});
}

/// People of a study at hand and their values of the family's checkpoints.
void drawFrom(PlannedStudy& planned, StudySource& source) {
  const analytics::Study study = studyOf(source);
  std::vector<const analytics::StudyRow*> rows;
  for (const analytics::StudyRow& row : study.rows) {
    const bool inFamily =
        study.protocol ? row.role == analytics::Role::primary : row.holm.has_value() || source.choices.family.empty();
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
      for (const std::string& name : rows[c]->worstRanked[g]) {
        auto& person = people[g][name];
        person.resize(rows.size());
        person[c] = rows[c]->worst;
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

/// "5:30:5", "12" or "8,10,15": people in the first group. @throws Error (invalid)
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
    if (!fault.empty() || by < 1)
      failPower(fmt::format("--n {}: the step is not a number from 1", recorder::shown(text)));
    const std::size_t from = number(parts[0]), to = number(parts[1]);
    for (std::size_t n = from; n <= to; n += static_cast<std::size_t>(by)) sizes.push_back(n);
  }
  if (sizes.empty() || sizes.size() > maxSizes)
    failPower(fmt::format("--n {}: {} sizes; from 1 to {} are allowed", recorder::shown(text), sizes.size(), maxSizes));
  return sizes;
}

/// @throws Error (invalid) for words that say nothing or too much, and as studyOf().
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
  // Draws from people have ties, whose exact distribution is counted each time.
  planned.plan.simulations = o.simulations > 0 ? o.simulations : data ? 2000 : 10000;
  planned.plan.seed = std::stoull(o.seed);
  return planned;
}

std::string shareText(const analytics::SimulatedShare& s) {
  return fmt::format("{:.3f} [{:.3f}, {:.3f}]", s.value, s.interval.lower, s.interval.upper);
}

Json shareJson(const analytics::SimulatedShare& s) {
  return {{"power", s.value}, {"lower", s.interval.lower}, {"upper", s.interval.upper}};
}

struct Sized {
  std::size_t nx, ny;
  analytics::Power power;
};

/// p that the first rejection needs: Holm asks for the level over the number of tests, else some test for the level.
double markOf(const PowerOptions& o, const PlannedStudy& planned) {
  return o.adjustment == "holm" ? o.level / static_cast<double>(planned.family) : o.level;
}

void printPower(const PowerOptions& o, const PlannedStudy& planned, const std::vector<Sized>& results,
                std::size_t enough, std::ostream& out) {
  if (planned.synthetic) out << analytics::watermarkText << '\n';
  out << fmt::format("Power of two-sided Mann-Whitney tests at {:g}, adjustment {}: {}\n", o.level, o.adjustment,
                     planned.origin);
  out << fmt::format("{} simulations each, seed {}; in brackets Wilson's 95 % interval of the simulation\n\n",
                     planned.plan.simulations, o.seed);
  analytics::ReportTable table = analytics::tableOf(
      "", {"n (" + planned.groups[0] + ")", "n (" + planned.groups[1] + ")", "=checkpoint", "power"});
  std::size_t untestable = 0;
  for (const Sized& r : results) {
    std::string nx = fmt::format("{}", r.nx), ny = fmt::format("{}", r.ny);
    const auto row = [&](const std::string& name, const analytics::SimulatedShare& share) {
      table.rows.push_back({nx, ny, name, shareText(share)});
      nx.clear();
      ny.clear();
    };
    for (std::size_t c = 0; c < planned.names.size(); ++c) row(planned.names[c], r.power.ofCheckpoint[c]);
    if (planned.names.size() > 1) {
      row("any effect", r.power.anyEffect);
      row("all effects", r.power.allEffects);
    }
    untestable += r.power.untestable;
  }
  table.print(out);
  out << '\n';
  for (const Sized& r : results) {
    const double smallest = analytics::smallestRankTestP(r.nx, r.ny);
    if (smallest <= markOf(o, planned)) continue;
    analytics::printWrapped(
        fmt::format("n = {} + {}: nothing can be rejected, the smallest p of a rank test is {:.2g} and "
                    "{:.2g} is needed.",
                    r.nx, r.ny, smallest, markOf(o, planned)),
        out);
  }
  if (untestable > 0) out << fmt::format("{} tests had no answer and count as not rejected.\n", untestable);
  out << (enough > 0
              ? fmt::format(
                    "From n = {} ({}) on, the power for all effects together reaches {:g} with its whole interval.\n",
                    enough, planned.groups[0], o.target)
              : fmt::format("At none of these sizes does the power for all effects together reach {:g} with its whole "
                            "interval.\n",
                            o.target));
}

void power(PowerOptions& o) {
  const std::vector<std::size_t> sizes = sizesOf(o.sizes);
  Progress progress("Simulating studies", o.json, "sizes");
  PlannedStudy planned = planOf(o);
  std::vector<Sized> results;
  std::size_t enough = 0;  // none yet
  for (const std::size_t n : sizes) {
    planned.plan.nx = n;
    planned.plan.ny = std::clamp(static_cast<std::size_t>(std::lround(o.allocation * static_cast<double>(n))),
                                 std::size_t{2}, maxPeople);
    const analytics::Expected<analytics::Power> answer = analytics::simulatePower(planned.plan);
    if (!answer) failPower(answer.reason());
    results.push_back({planned.plan.nx, planned.plan.ny, *answer});
    const bool reached = answer->allEffects.interval.lower >= o.target;
    if (!reached) enough = 0;
    if (reached && enough == 0) enough = n;
    progress.show(results.size(), sizes.size());
  }
  Progress::erase();
  Json j{{"synthetic", planned.synthetic},
         {"distributions", planned.origin},
         {"groups", planned.groups},
         {"level", o.level},
         {"adjustment", o.adjustment},
         {"simulations", planned.plan.simulations},
         {"seed", o.seed},
         {"target", o.target},
         {"enough", enough > 0 ? Json(enough) : Json(nullptr)},
         {"sizes", Json::array()}};
  for (const Sized& r : results) {
    Json row{{"n", {r.nx, r.ny}}, {"checkpoints", Json::array()}};
    for (std::size_t c = 0; c < planned.names.size(); ++c) {
      Json one = shareJson(r.power.ofCheckpoint[c]);
      one["checkpoint"] = planned.names[c];
      row["checkpoints"].push_back(one);
    }
    row["smallest_p"] = analytics::smallestRankTestP(r.nx, r.ny);
    row["needed_p"] = markOf(o, planned);
    row["any_effect"] = shareJson(r.power.anyEffect);
    row["all_effects"] = shareJson(r.power.allEffects);
    row["untestable"] = r.power.untestable;
    j["sizes"].push_back(row);
  }
  printResult(o.json, "power", j, [&](std::ostream& out) { printPower(o, planned, results, enough, out); });
}

}  // namespace

void addPower(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(app, run,
                                       {"power", "How many people a study needs, by simulating the study itself",
                                        "calot power --effect 1.2 --n 8:20:4", "calot power pilot.db --n 10:40:10"},
                                       power);
  addStudySource(*command, o->source);
  addList(*command, "--effect", o->effects,
          "Shift of the first group in standard deviations, one a checkpoint: A,B,...; 0: none");
  command
      ->add_option("--checkpoint", o->checkpoints,
                   "NAME:MEAN,SD,MEAN,SD of the first and the second group; may be repeated")
      ->allow_extra_args(false);
  addChoice(*command, "--shape", o->shape, "Distribution for --effect and --checkpoint", {"normal", "lognormal"});
  command->add_option("--n", o->sizes, "People in the first group: FROM:TO:STEP, A,B,C or one number")
      ->capture_default_str();
  addNumber(*command, "--allocation", o->allocation, "People in the second group for each in the first", 0.1, 10.0);
  addNumber(*command, "--correlation", o->correlation, "Correlation of a participant's checkpoints with each other",
            0.0, 0.99);
  addNumber(*command, "--step", o->step, "Round values to multiples of it (scores, counts); 0: not", 0.0, 1e6);
  addChoice(*command, "--adjustment", o->adjustment, "Adjustment of the p values of all checkpoints",
            {"holm", "benjamini-hochberg", "none"});
  addNumber(*command, "--level", o->level, "Level of significance", 0.0001, 0.5);
  addNumber(*command, "--target", o->target, "Power to reach", 0.01, 0.99);
  command->add_option("--simulations", o->simulations, "Studies a size; default 10000, from people at hand 2000")
      ->check(CLI::Range(std::uint64_t{100}, std::uint64_t{1000000}));
  command->add_option("--seed", o->seed, "Seed of the simulation")->check(wholeNumber)->capture_default_str();
  command->add_flag("--json", o->json, "Print JSON");
  // These are the protocol's.
  for (const char* name : {"--level", "--adjustment"}) command->get_option(name)->excludes("--protocol");
}

}  // namespace calot::apps
