// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <system_error>

#include "analytics/report/study_output.h"
#include "recorder/errors.h"

namespace calot::analytics {
namespace {

/// A cell by RFC 4180. One that a spreadsheet would take for a formula gets an apostrophe before it.
std::string cell(const std::string& text) {
  std::string safe = text;
  if (!safe.empty() && std::string("=+-@\t\r").find(safe.front()) != std::string::npos) safe.insert(safe.begin(), '\'');
  if (safe.find_first_of(",\"\r\n") == std::string::npos) return safe;
  std::string quoted = "\"";
  for (const char c : safe) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string number(const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; }

std::string watermark(const Study& study) { return study.synthetic ? "SYNTHETIC" : ""; }

std::string summaryTable(const Study& study) {
  std::string text =
      "checkpoint,subject,unit,direction,group_a,n_a,missing_a,mean_a,sd_a,q1_a,median_a,q3_a,group_b,n_b,missing_b,"
      "mean_b,sd_b,"
      "q1_b,median_b,q3_b,shift,shift_lower,shift_upper,shift_level,u,p,p_method,cliffs_delta,a,no_test_because,"
      "published_expert_mean,published_novice_mean,study,watermark\n";
  for (const StudyRow& row : study.rows) {
    text += fmt::format("{},{},{},{}", cell(row.checkpoint), cell(row.subject), cell(row.unit), nameOf(row.direction));
    for (std::size_t g = 0; g < 2; ++g) {
      const GroupSummary& s = row.group[g];
      text +=
          fmt::format(",{},{},{},{},{},{},{},{}", cell(study.groups[g]), s.n, s.missing, number(s.mean),
                      number(s.standardDeviation), number(s.lowerQuartile), number(s.median), number(s.upperQuartile));
    }
    text += row.shift ? fmt::format(",{}", *row.shift) : ",";
    text += row.shiftInterval ? fmt::format(",{},{},{}", row.shiftInterval->lower, row.shiftInterval->upper,
                                            row.shiftInterval->attained)
                              : ",,,";
    text +=
        row.test ? fmt::format(",{},{},{}", row.test->u, row.test->p, row.test->exact ? "exact" : "asymptotic") : ",,,";
    text += row.effect ? fmt::format(",{},{}", row.effect->delta, row.effect->a) : ",,";
    text += fmt::format(",{},{},{},{},{}\n", cell(row.test.reason()), number(row.publishedExpert),
                        number(row.publishedNovice), study.heading, watermark(study));
  }
  return text;
}

std::string valuesTable(const Study& study) {
  std::string text = "checkpoint,subject,unit,group,participant,value,watermark\n";
  for (const StudyRow& row : study.rows) {
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t i = 0; i < row.values[g].size(); ++i) {
        text += fmt::format("{},{},{},{},{},{},{}\n", cell(row.checkpoint), cell(row.subject), cell(row.unit),
                            cell(study.groups[g]), cell(row.participants[g][i]), row.values[g][i], watermark(study));
      }
    }
  }
  return text;
}

std::string flowTable(const Study& study) {
  std::string text = fmt::format("stage,attempts\nin the cohort,{}\n", study.recruited);
  for (const FlowRow& row : study.flow) text += fmt::format("{},{}\n", cell("left out: " + row.reason), row.attempts);
  return text + fmt::format("analysed,{}\n", study.analysed);
}

void writeFile(const std::filesystem::path& path, const std::string& text) {
  const std::filesystem::path temporary = path.string() + ".part";
  std::error_code ignored;
  std::ofstream out(temporary, std::ios::binary | std::ios::trunc);
  out << text;
  out.close();
  std::error_code failed;
  if (out) std::filesystem::rename(temporary, path, failed);
  if (!out || failed) {
    std::filesystem::remove(temporary, ignored);
    throw Error(ExitCode::failure,
                fmt::format("{}: can't be written; check folder, permissions and free space", path.string()));
  }
}

}  // namespace

void writeStudyCsv(const Study& study, const std::string& folder, bool force) {
  const std::filesystem::path root(folder);
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error || !std::filesystem::is_directory(root, error)) {
    throw Error(ExitCode::failure, fmt::format("{}: the folder can't be made", folder));
  }
  const std::pair<const char*, std::string> files[] = {
      {"study.csv", summaryTable(study)}, {"values.csv", valuesTable(study)}, {"flow.csv", flowTable(study)}};
  for (const auto& file : files) {
    if (!force && std::filesystem::exists(root / file.first, error)) {
      throw Error(ExitCode::usage,
                  fmt::format("{}: is there already; use --force to replace it", (root / file.first).string()));
    }
  }
  for (const auto& file : files) writeFile(root / file.first, file.second);
}

}  // namespace calot::analytics
