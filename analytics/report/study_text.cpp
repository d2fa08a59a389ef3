// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "analytics/report/study_output.h"
#include "analytics/report/text_table.h"

namespace calot::analytics {
namespace {

using Align = TextTable::Align;

std::string number(const std::optional<double>& value) { return value ? significant(*value) : "-"; }

std::string published(const StudyRow& row) {
  if (!row.publishedExpert) return "";
  return fmt::format("{} / {}", *row.publishedExpert, *row.publishedNovice);  // as printed there
}

std::string nameOfRow(const StudyRow& row) {
  return row.subject.empty() ? row.checkpoint : fmt::format("{} {}", row.checkpoint, row.subject);
}

}  // namespace

void printStudy(const Study& study, std::ostream& out) {
  const std::string &a = study.groups[0], &b = study.groups[1];
  if (study.synthetic) out << "SYNTHETIC: made by performers, says nothing about people\n";
  out << fmt::format("Study ({}): {} against {}\n\n", study.heading, a, b);
  out << fmt::format("{} attempts in the cohort\n", study.recruited);
  for (const FlowRow& row : study.flow) out << fmt::format("  {} left out: {}\n", row.attempts, row.reason);
  out << fmt::format(
      "  {} analysed: {} {} ({} attempts), {} {} ({} attempts); one value each, the mean of its attempts\n\n",
      study.analysed, study.participants[0], a, study.attempts[0], study.participants[1], b, study.attempts[1]);
  TextTable table({{"checkpoint", Align::left},
                   {"unit", Align::left},
                   {"better", Align::left},
                   {"n", Align::right},
                   {"mean " + a, Align::right},
                   {"median", Align::right},
                   {"n", Align::right},
                   {"mean " + b, Align::right},
                   {"median", Align::right},
                   {"shift", Align::right},
                   {"p", Align::right},
                   {"delta", Align::right},
                   {"paper E / N", Align::right}});
  std::vector<std::string> reasons;
  for (const StudyRow& row : study.rows) {
    const GroupSummary &x = row.group[0], &y = row.group[1];
    if (x.n == 0 && y.n == 0) {
      // One line for what nobody has: a scene without fat has many of these.
      std::string why = x.missingReason;
      if (y.missingReason != why) why += (why.empty() ? "" : "; ") + y.missingReason;
      reasons.push_back(fmt::format("{}: no value in either group ({})", nameOfRow(row), why));
      continue;
    }
    table.add({nameOfRow(row), row.unit, row.direction == Direction::none ? "" : nameOf(row.direction),
               fmt::format("{}", x.n), number(x.mean), number(x.median), fmt::format("{}", y.n), number(y.mean),
               number(y.median), row.shift ? significant(*row.shift) : "-",
               row.test ? pText(row.test->p) + (row.test->exact ? "" : "~") : "-",
               row.effect ? fmt::format("{:+.3f}", row.effect->delta) : "-", published(row)});
    if (!row.test) reasons.push_back(fmt::format("{}: no test, {}", nameOfRow(row), row.test.reason()));
    for (std::size_t g = 0; g < 2; ++g) {
      if (row.group[g].missing > 0) {
        reasons.push_back(fmt::format("{}: {} of {} {} without a value ({})", nameOfRow(row), row.group[g].missing,
                                      row.group[g].missing + row.group[g].n, study.groups[g],
                                      row.group[g].missingReason));
      }
    }
  }
  table.print(out);
  out << fmt::format(
      "\nshift: Hodges-Lehmann, {} - {}. p: Mann-Whitney, two-sided, exact with ties (~: normal approximation), not "
      "adjusted for\n"
      "the number of rows. delta: Cliff's, +1 when every {} exceeds every {}.\n",
      a, b, a, b);
  bool anyPublished = false;
  for (const StudyRow& row : study.rows) anyPublished = anyPublished || row.publishedExpert.has_value();
  if (anyPublished) {
    out << fmt::format("paper E / N: published means of ten experts and ten novices, for reference only\n({}).\n",
                       study.publishedSource);
  }
  for (const std::string& remark : study.remarks) out << remark << '\n';
  for (const std::string& reason : reasons) out << reason << '\n';
  if (study.synthetic) out << "SYNTHETIC: made by performers, says nothing about people\n";
}

}  // namespace calot::analytics
