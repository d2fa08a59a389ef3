// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "recorder/base/text_output.h"
#include "recorder/replay.h"

namespace calot::recorder {

namespace {

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
  }
  return out;
}

}  // namespace

void writeJunit(const std::filesystem::path& file, const std::vector<ReplayReport>& reports,
                const JunitOptions& options) {
  const auto count = [&](ReplayVerdict v) {
    return std::count_if(reports.begin(), reports.end(), [v](const ReplayReport& r) { return r.verdict == v; });
  };
  const auto undecided = count(ReplayVerdict::undecided);
  double time = 0.0;
  for (const ReplayReport& r : reports) time += r.wallSeconds;
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  xml +=
      fmt::format("<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3f}\">\n",
                  escaped(options.suite), reports.size(), count(ReplayVerdict::diverged),
                  count(ReplayVerdict::damaged) + (options.skipUndecided ? 0 : undecided),
                  options.skipUndecided ? undecided : 0, time);
  for (const ReplayReport& r : reports) {
    xml += fmt::format("  <testcase classname=\"replay\" name=\"{}\" time=\"{:.3f}\"",
                       escaped(r.path.filename().string()), r.wallSeconds);
    const std::string body = escaped(r.message);
    switch (r.verdict) {
      case ReplayVerdict::exact:
      case ReplayVerdict::consistent:
        xml += "/>\n";
        continue;
      case ReplayVerdict::diverged:
        xml += fmt::format(">\n    <failure message=\"diverged\">{}</failure>\n", body);
        break;
      case ReplayVerdict::damaged:
        xml += fmt::format(">\n    <error message=\"damaged\">{}</error>\n", body);
        break;
      case ReplayVerdict::undecided:
        xml += options.skipUndecided
                   ? fmt::format(">\n    <skipped message=\"{}\"/>\n", body)
                   : fmt::format(">\n    <error message=\"of another simulation version\">{}</error>\n", body);
        break;
    }
    xml += "  </testcase>\n";
  }
  xml += "</testsuite>\n";
  writeText(file, xml, options.force);
}

}  // namespace calot::recorder
