// SPDX-License-Identifier: GPL-3.0-or-later
// calot power: how many people a study needs, by simulating the study itself.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytics/report/study_tables.h"
#include "analytics/statistics/two_groups.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/power_plan.h"
#include "apps/calot/results.h"
#include "apps/calot/wrong_word.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

using Json = nlohmann::ordered_json;

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

void print(const PowerOptions& o, const PlannedStudy& planned, const std::vector<Sized>& results, std::size_t enough) {
  if (planned.synthetic) std::cout << analytics::watermarkText << '\n';
  std::cout << fmt::format("Power of two-sided Mann-Whitney tests at {:g}, adjustment {}: {}\n", o.level, o.adjustment,
                           planned.origin);
  std::cout << fmt::format("{} simulations each, seed {}; in brackets Wilson's 95 % interval of the simulation\n\n",
                           planned.plan.simulations, o.seed);
  using Align = analytics::TextTable::Align;
  analytics::TextTable table({{"n (" + planned.groups[0] + ")", Align::right},
                              {"n (" + planned.groups[1] + ")", Align::right},
                              {"checkpoint", Align::left},
                              {"power", Align::right}});
  std::size_t untestable = 0;
  for (const Sized& r : results) {
    std::string nx = fmt::format("{}", r.nx), ny = fmt::format("{}", r.ny);
    const auto row = [&](const std::string& name, const analytics::SimulatedShare& share) {
      table.add({nx, ny, name, shareText(share)});
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
  table.print(std::cout);
  std::cout << '\n';
  for (const Sized& r : results) {
    const double smallest = analytics::smallestRankTestP(r.nx, r.ny);
    if (smallest <= markOf(o, planned)) continue;
    analytics::printWrapped(
        fmt::format("n = {} + {}: nothing can be rejected, the smallest p of a rank test is {:.2g} and "
                    "{:.2g} is needed.",
                    r.nx, r.ny, smallest, markOf(o, planned)),
        std::cout);
  }
  if (untestable > 0) std::cout << fmt::format("{} tests had no answer and count as not rejected.\n", untestable);
  if (enough > 0) {
    std::cout << fmt::format("From n = {} ({}) on all effects together reach {:g} with the whole interval.\n", enough,
                             planned.groups[0], o.target);
  } else {
    std::cout << fmt::format("None of these sizes reaches {:g} for all effects together with the whole interval.\n",
                             o.target);
  }
}

int power(PowerOptions& o) {
  const std::vector<std::size_t> sizes = sizesOf(o.sizes);
  PlannedStudy planned = planOf(o);
  std::vector<Sized> results;
  std::size_t enough = 0;  // none yet
  Progress progress("simulating, sizes", o.json);
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
  if (!o.json) {
    print(o, planned, results, enough);
    return static_cast<int>(ExitCode::yes);
  }
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
  printResult("power", j);
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

void addPower(CLI::App& app, Run& run) {
  const auto o = std::make_shared<PowerOptions>();
  CLI::App* command = app.add_subcommand("power", "How many people a study needs, by simulating the study itself");
  addStudySource(*command, o->source);
  command
      ->add_option("--effect", o->effects,
                   "Shift of the first group in standard deviations, one a checkpoint: A,B,...; 0: none")
      ->delimiter(',')
      ->allow_extra_args(false);
  command
      ->add_option("--checkpoint", o->checkpoints,
                   "NAME:MEAN,SD,MEAN,SD of the first and the second group; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--shape", o->shape, "Of --effect and --checkpoint")
      ->check(oneOf({"normal", "lognormal"}))
      ->capture_default_str();
  command->add_option("--n", o->sizes, "People in the first group: FROM:TO:STEP, A,B,C or one number")
      ->capture_default_str();
  command->add_option("--allocation", o->allocation, "People in the second group for each in the first")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  command->add_option("--correlation", o->correlation, "Of a participant's checkpoints with each other")
      ->check(CLI::Range(0.0, 0.99))
      ->capture_default_str();
  command->add_option("--step", o->step, "Round values to multiples of it (scores, counts); 0: not")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_option("--adjustment", o->adjustment, "Of the p values of all checkpoints")
      ->check(oneOf({"holm", "benjamini-hochberg", "none"}))
      ->capture_default_str();
  command->add_option("--level", o->level, "Level of significance")
      ->check(CLI::Range(0.0001, 0.5))
      ->capture_default_str();
  command->add_option("--target", o->target, "Power that is wanted")
      ->check(CLI::Range(0.01, 0.99))
      ->capture_default_str();
  command->add_option("--simulations", o->simulations, "Studies a size; default 10000, from people at hand 2000")
      ->check(CLI::Range(std::uint64_t{100}, std::uint64_t{1000000}));
  command->add_option("--seed", o->seed, "Of the simulation")->check(wholeNumber)->capture_default_str();
  command->add_flag("--json", o->json, "Print JSON");
  // These are the protocol's.
  for (const char* name : {"--level", "--adjustment"}) command->get_option(name)->excludes("--protocol");
  command->callback([o, &run] { run = [o] { return power(*o); }; });
}

}  // namespace calot::apps
