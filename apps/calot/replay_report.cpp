// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/calot/replay_report.h"

#include <algorithm>
#include <iterator>

#include <array>
#include "analytics/checkpoints/motion.h"
#include "analytics/checkpoints/replay_words.h"
#include "analytics/cohort/registers.h"
#include "apps/calot/command.h"
#include "recorder/base/files.h"

namespace calot::apps {

void printReport(const recorder::ReplayReport& r) {
  if (r.verdict == recorder::ReplayVerdict::exact) {
    printText(fmt::format("{}: bit-exact{}, {:.2f} s ({} steps), {:.1f} x real time\n", r.path.string(),
                          r.complete ? "" : ", incomplete", r.seconds, r.steps,
                          r.wallSeconds > 0.0 ? r.seconds / r.wallSeconds : 0.0));
    if (r.misses.any > 0) printText(fmt::format("{}: {}\n", r.path.string(), analytics::wordsFor(r.misses)));
    return;
  }
  if (r.verdict == recorder::ReplayVerdict::consistent) {
    printText(fmt::format("{}: {}\n", r.path.string(), analytics::wordsFor(r)));
    return;
  }
  Progress::erase();
  fmt::print(stderr, "calot: {}: {}\n", r.path.string(), advised(analytics::wordsFor(r), r.remedies));
}

Json missesJson(const recorder::StepMisses& m) {
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
    const std::string body = analytics::escaped(analytics::wordsFor(r));
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
                      {"chain_intact", r.chainIntact()},
                      {"message", analytics::wordsFor(r)},
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

const char* importedName(analytics::Imported imported) {
  constexpr const char* names[] = {"added", "unchanged", "extended"};
  return names[static_cast<std::size_t>(imported)];
}

namespace {

Json intervalJson(const analytics::ValueInterval& i) {
  if (!i.lower) return {{"lower", nullptr}, {"upper", nullptr}, {"reason", i.reason}};
  return Json{{"lower", *i.lower},           {"upper", *i.upper},           {"limit", i.limit()},
              {"step_effect", i.stepEffect}, {"mesh_effect", i.meshEffect}, {"constants_spread", i.constantsSpread}};
}

}  // namespace

Json jsonOf(const std::vector<analytics::CheckpointValue>& values,
            const std::vector<analytics::ValueInterval>& intervals) {
  Json list = Json::array();
  for (const analytics::CheckpointValue& v : values) {
    Json row = {{"name", v.name}, {"subject", v.subject}, {"version", v.version}};
    row["value"] = v.value ? Json(*v.value) : Json();
    row["unit"] = v.unit;
    row["origin"] = nameOf(v.origin);
    if (v.metric) row["sha256"] = v.metric->sha256;
    row["filter"] = v.filter;
    if (!v.value) {
      row["missing"] = nameOf(v.availability);
      row["reason"] = v.reason;
    }
    if (!v.note.empty()) row["note"] = v.note;
    if (v.coverage) row["coverage"] = *v.coverage;
    if (v.rate) row["rate"] = *v.rate;
    if (v.noise) row["noise"] = *v.noise;
    if (const analytics::ValueInterval* interval = analytics::findInterval(intervals, v))
      row["interval"] = intervalJson(*interval);
    list.push_back(row);
  }
  return list;
}

void addStoring(CLI::App& command, std::string& cohort, double& cutoff) {
  command.add_option("--cohort", cohort, "cohort database; made where there is none");
  command
      .add_option("--cutoff", cutoff,
                  "instead of --cohort: cut-off of the motion filter (Hz), 3, 6 or 10; shows, stores nothing")
      ->check([](const std::string& text) {
        const bool known = std::any_of(std::begin(analytics::motionCutoffs), std::end(analytics::motionCutoffs),
                                       [&](double hertz) { return text == std::to_string(static_cast<int>(hertz)); });
        return known ? std::string() : std::string("3, 6 or 10 is expected");
      });
}

void checkStored(const std::string& cohort, double cutoff) {
  if (cohort.empty() && cutoff == 0.0)
    throw Error(ErrorKind::invalid, "--cohort: a database for the values is expected (or --cutoff, to see them only)");
  if (!cohort.empty() && cutoff != 0.0) {
    throw Error(ErrorKind::invalid,
                "--cutoff: values of a cohort have one filter, 6 Hz; leave out --cohort to see those of another");
  }
}

std::string keyFaultOf(const analytics::AttemptRecord& attempt, const std::string& cohort) {
  if (attempt.station.empty()) return {};
  std::optional<analytics::PublicKey> key;
  if (attempt.signature) key = attempt.signature->publicKey;
  switch (analytics::standingOf(analytics::readRegisters(cohort), attempt.station, key)) {
    case analytics::KeyStanding::another:
      return fmt::format("signed by another key than that of station {} in {}", attempt.station, cohort);
    case analytics::KeyStanding::unsignedButExpected:
      return fmt::format("not signed, though station {} has a key in {}", attempt.station, cohort);
    default:
      return {};
  }
}

}  // namespace calot::apps
