// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/norm_angoff.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "analytics/assessment/norm_rule.h"
#include "analytics/report/report_document.h"
#include "apps/calot/results.h"
#include "apps/common/exit_code.h"

namespace calot::apps {
namespace {

struct AngoffOptions {
  std::string table;
  bool json = false;
};

int judgeByAngoff(const AngoffOptions& o) {
  using Align = analytics::TextTable::Align;
  const analytics::AngoffJudgement a = analytics::readAngoff(readCsvTable(o.table));
  const double judges = static_cast<double>(a.judges.size());
  analytics::ReportTable table{
      "Probability that a borderline trainee passes",
      {{"item", Align::left}, {"mean", Align::right}, {"least", Align::right}, {"most", Align::right}},
      {}};
  nlohmann::ordered_json items = nlohmann::ordered_json::array();
  for (std::size_t item = 0; item < a.items.size(); ++item) {
    double sum = 0.0, least = 1.0, most = 0.0;
    for (std::size_t j = 0; j < a.judges.size(); ++j) {
      const double p = a.probabilities.at(j, item);
      sum += p;
      if (p < least) least = p;
      if (p > most) most = p;
    }
    table.rows.push_back({a.items[item], fmt::format("{:.2f}", sum / judges), fmt::format("{:.2f}", least),
                          fmt::format("{:.2f}", most)});
    items.push_back({{"item", a.items[item]}, {"mean", sum / judges}, {"least", least}, {"most", most}});
  }
  if (o.json) {
    printResult("norm-angoff", {{"judges", a.judges},
                                {"items", items},
                                {"cut", a.cut.cut},
                                {"error", a.cut.error},
                                {"lower", a.cut.interval.lower},
                                {"upper", a.cut.interval.upper},
                                {"needed", a.needed}});
    return static_cast<int>(ExitCode::yes);
  }
  analytics::printTable(table, std::cout);
  analytics::printWrapped(
      fmt::format(
          "Angoff's mark by {} judges: {} of {} items, 95 % [{}, {}] by Student's t over the judges. The rule of "
          "norm create: --rule at-least:{}.",
          a.judges.size(), analytics::significant(a.cut.cut), a.items.size(),
          analytics::significant(a.cut.interval.lower), analytics::significant(a.cut.interval.upper), a.needed),
      std::cout);
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

void addNormAngoff(CLI::App& norm, Run& run) {
  const auto o = std::make_shared<AngoffOptions>();
  CLI::App* command =
      norm.add_subcommand("angoff", "How many figures a borderline trainee passes, by judges (Angoff), for --rule");
  command->add_option("judges", o->table, "CSV file: a column judge, and one of probabilities for each figure")
      ->required();
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] { run = [o] { return judgeByAngoff(*o); }; });
}

}  // namespace calot::apps
