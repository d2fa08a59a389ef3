// SPDX-License-Identifier: GPL-3.0-or-later
// calot checkpoints: what this build computes, and how it is defined.

#include "analytics/checkpoints/checkpoint.h"
#include "apps/calot/command.h"

namespace calot::apps {
namespace {

using analytics::CheckpointDefinition;

std::vector<std::string> originNames(const CheckpointDefinition& d) {
  std::vector<std::string> names;
  for (const analytics::Origin origin : d.origins) names.push_back(nameOf(origin));
  return names;
}

Json definitionJson(const CheckpointDefinition& d) {
  return {{"name", d.name},
          {"title", d.title},
          {"unit", d.unit},
          {"display_unit", d.displayUnit},
          {"display_factor", d.displayFactor},
          {"direction", nameOf(d.direction)},
          {"window", d.window},
          {"aggregation", nameOf(d.aggregation)},
          {"instruments", d.instruments},
          {"filter", d.filter},
          {"min_coverage", d.minCoverage},
          {"origins", originNames(d)},
          {"finality", nameOf(d.finality)},
          {"version", d.version},
          {"definition", d.definition},
          {"paper", d.paperReading},
          {"outcome", d.notOutcome.empty()},
          {"not_outcome_because", d.notOutcome}};
}

std::string definitionText(const CheckpointDefinition& d) {
  const std::size_t columns = terminalColumns();
  std::string all = wrappedText(fmt::format("{} (version {}): {}", d.name, d.version, d.title), columns, 4) + '\n';
  const auto line = [&](const char* word, const std::string& text) {
    if (!text.empty()) all += fmt::format("  {:<12} {}\n", word, wrappedText(text, columns, 15, 15));
  };
  line("definition", d.definition);
  line("unit", d.unit == d.displayUnit ? d.unit : fmt::format("{} (shown in {})", d.unit, d.displayUnit));
  line("better", nameOf(d.direction));
  line("given for", fmt::format("each {}", nameOf(d.aggregation)));
  line("instruments", d.instruments);
  line("window", d.window);
  line("filter", d.filter);
  line("coverage", coverageText(d));
  line("origin", fmt::format("{}", fmt::join(originNames(d), ", ")));
  line("known", d.finality == analytics::Finality::running ? "after every step" : "at the end");
  line("paper", d.paperReading);
  line("outcome", d.notOutcome.empty() ? "" : "no: " + d.notOutcome);
  return all;
}

void listCheckpoints(const JsonOption& o) {
  Json list = Json::array();
  std::string text;
  for (const analytics::CheckpointEntry& entry : analytics::checkpointRegistry()) {
    list.push_back(definitionJson(entry.definition));
    text += definitionText(entry.definition);
  }
  printResult(o.json, "checkpoints", {{"checkpoints", list}}, text);
}

}  // namespace

void addCheckpoints(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run, {"checkpoints", "List the checkpoints and their definitions", "calot checkpoints --json"},
                 listCheckpoints);
  command->add_flag("--json", o->json, "Print JSON");
}

}  // namespace calot::apps
