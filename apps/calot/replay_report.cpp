// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/replay_report.h"

#include <fmt/format.h>

#include <array>

#include "analytics/report/report_text.h"
#include "apps/calot/environment.h"
#include "apps/common/advice.h"
#include "apps/common/exit_code.h"
#include "recorder/base/text_output.h"

namespace calot::apps {

void printReport(const recorder::ReplayReport& r) {
  Progress::erase();
  if (r.verdict == recorder::ReplayVerdict::exact) {
    fmt::print("{}: bit-exact{}, {:.2f} s ({} steps), {:.1f} x real time\n", r.path.string(),
               r.complete ? "" : ", incomplete", r.seconds, r.steps,
               r.wallSeconds > 0.0 ? r.seconds / r.wallSeconds : 0.0);
    if (r.misses.any > 0) fmt::print("{}: {}\n", r.path.string(), describe(r.misses));
    return;
  }
  if (r.verdict == recorder::ReplayVerdict::consistent) {
    fmt::print("{}: {}\n", r.path.string(), r.message);
    return;
  }
  fmt::print(stderr, "calot: {}: {}\n", r.path.string(), advised(r.message, r.remedies));
}

nlohmann::ordered_json missesJson(const recorder::StepMisses& m) {
  return {{"steps", m.any}, {"solver", m.solver}, {"contact", m.contact}, {"held_back", m.heldBack}};
}

void addJunitOptions(CLI::App& command, JunitOptions& options) {
  CLI::Option* junit = command.add_option("--junit", options.file, "write the result as JUnit XML");
  command
      .add_flag("--skip-other-versions", options.skipUndecided,
                "in the JUnit XML, recordings of another simulation version are skipped, not errors (still exit 5)")
      ->needs(junit);
  command.add_flag("--force", options.force, "replace the JUnit XML if it is there")->needs(junit);
}

void writeJunit(const JunitOptions& options, const std::string& suite,
                const std::vector<recorder::ReplayReport>& reports) {
  using recorder::ReplayVerdict;
  if (options.file.empty()) return;
  std::array<std::size_t, 5> count{};
  double time = 0.0;
  std::string cases;
  for (const recorder::ReplayReport& r : reports) {
    ++count[static_cast<std::size_t>(r.verdict)];
    time += r.wallSeconds;
    cases += fmt::format("  <testcase classname=\"replay\" name=\"{}\" time=\"{:.3f}\">",
                         analytics::escaped(r.path.filename().string()), r.wallSeconds);
    const std::string body = analytics::escaped(r.message);
    if (r.verdict == ReplayVerdict::diverged) cases += fmt::format("<failure message=\"diverged\">{}</failure>", body);
    if (r.verdict == ReplayVerdict::damaged) cases += fmt::format("<error message=\"damaged\">{}</error>", body);
    if (r.verdict == ReplayVerdict::undecided) {
      cases += options.skipUndecided ? fmt::format("<skipped message=\"{}\"/>", body)
                                     : fmt::format("<error message=\"of another simulation version\">{}</error>", body);
    }
    cases += "</testcase>\n";
  }
  const auto of = [&](ReplayVerdict verdict) { return count[static_cast<std::size_t>(verdict)]; };
  const std::size_t skipped = options.skipUndecided ? of(ReplayVerdict::undecided) : 0;
  const std::size_t errors = of(ReplayVerdict::damaged) + of(ReplayVerdict::undecided) - skipped;
  const std::string head =
      fmt::format("<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{:.3f}\">\n",
                  analytics::escaped(suite), reports.size(), of(ReplayVerdict::diverged), errors, skipped, time);
  recorder::writeText(options.file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n" + head + cases + "</testsuite>\n",
                      options.force);
}

nlohmann::json reportJson(const recorder::ReplayReport& r) {
  nlohmann::json json{{"file", r.path.string()},
                      {"verdict", recorder::wordFor(r.verdict)},
                      {"attempt", r.attempt},
                      {"complete", r.complete},
                      {"steps", r.steps},
                      {"seconds", r.seconds},
                      {"wall_seconds", r.wallSeconds},
                      {"missed_tolerance", missesJson(r.misses)},
                      {"simulation_version", r.simulationVersion},
                      {"chain_intact", r.chainIntact},
                      {"message", r.message},
                      {"exit_code", static_cast<int>(codeOf(r.fault()))}};
  if (!r.remedies.empty()) json["advice"] = advice(r.remedies);
  if (r.divergence) {
    nlohmann::json d{{"step", r.divergence->step},
                     {"component", r.divergence->component},
                     {"field", r.divergence->field},
                     {"detail", r.divergence->detail}};
    if (r.divergence->tick) d["tick"] = *r.divergence->tick;
    if (r.reproducible) d["reproducible"] = *r.reproducible;
    json["divergence"] = d;
  }
  return json;
}

ExitCode worstOf(const std::vector<recorder::ReplayReport>& reports) {
  std::vector<ExitCode> codes;
  codes.reserve(reports.size());
  for (const recorder::ReplayReport& report : reports) codes.push_back(codeOf(report.fault()));
  return worstOf(codes);
}

}  // namespace calot::apps
