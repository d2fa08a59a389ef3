// SPDX-License-Identifier: GPL-3.0-or-later
// calot norm: named, versioned cohorts that others are held against.
#include <algorithm>

#include "analytics/assessment/grade.h"
#include "analytics/assessment/norm.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/figure_number.h"
#include "analytics/report/report_document.h"
#include "analytics/report/study_output.h"
#include "analytics/report/terminal_text.h"
#include "analytics/report/value_tree.h"
#include "apps/calot/command.h"
#include "apps/calot/environment.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"

namespace calot::apps {
namespace {

struct AngoffOptions {
  std::string table;
  recorder::SimilarNames similarNames = recorder::SimilarNames::ask;
  bool json = false;
};

void judgeByAngoff(const AngoffOptions& o) {
  CsvTable table = readCsvTable(o.table);
  recorder::spellNames(table, {{"judge"}}, o.similarNames);
  const analytics::AngoffJudgement a = analytics::readAngoff(table);
  Json items = Json::array();
  for (std::size_t item = 0; item < a.items.size(); ++item) {
    double sum = 0.0, least = 1.0, most = 0.0;
    for (std::size_t j = 0; j < a.judges.size(); ++j) {
      const double p = a.probabilities.at(j, item);
      sum += p;
      least = std::min(least, p);
      most = std::max(most, p);
    }
    items.push_back({{"item", a.items[item]},
                     {"mean", sum / static_cast<double>(a.judges.size())},
                     {"least", least},
                     {"most", most}});
  }
  const Json all{{"judges", a.judges},
                 {"items", items},
                 {"cut", a.cut.cut},
                 {"error", a.cut.error},
                 {"lower", a.cut.interval.lower},
                 {"upper", a.cut.interval.upper},
                 {"needed", a.needed}};
  printResult(o.json, "norm-angoff", all, [&](std::ostream& out) {
    using namespace analytics;
    printTable(tableOf("Probability that a borderline trainee passes", items,
                       {{"=item", "/item", plain},
                        {"mean", "/mean", share2},
                        {"least", "/least", share2},
                        {"most", "/most", share2}}),
               out);
    printWrapped(
        fmt::format(
            "Angoff's mark by {} judges: {} of {} items, 95 % [{}, {}] by Student's t over the judges. The rule of "
            "norm create: --rule at-least:{}.",
            a.judges.size(), significant(a.cut.cut), a.items.size(), significant(a.cut.interval.lower),
            significant(a.cut.interval.upper), a.needed),
        out);
  });
}

using Access = analytics::CohortDatabase::Access;

constexpr std::size_t maxEvidence = std::size_t{1} << 30U;

struct NormOptions {
  analytics::BorderlineMark borderline;
  std::string database, name, by, groupBy = "group", attemptRule, rule, seed = "1", statement, file, protocol;
  std::vector<std::string> fixed;
  analytics::NormRequest request;
  unsigned version = 0;
  bool json = false;
};

/// "all" or "at-least:K".
std::uint32_t minOf(const std::string& rule) {
  constexpr std::string_view prefix = "at-least:";
  if (rule == "all") return 0;
  std::string fault;
  const bool counted = rule.rfind(prefix, 0) == 0;
  const long long least = counted ? recorder::readWholeNumber(rule.substr(prefix.size()), fault) : 0;
  if (!fault.empty() || least < 1 || least > 1000)
    throw Error(ErrorKind::invalid,
                fmt::format("norm: --rule {}: all, or at-least:K is expected", recorder::shown(rule)));
  return static_cast<std::uint32_t>(least);
}

Json normJson(const analytics::Norm& norm) {
  const auto [competent, others] = analytics::passRates(norm);
  Json j{{"name", norm.name},
         {"version", norm.version},
         {"created_utc", norm.createdUtc},
         {"by", norm.by},
         {"synthetic", norm.synthetic},
         {"judged_by", norm.judgedBy},
         {"comparability_key", norm.comparabilityKey},
         {"members", norm.members.size()},
         {"members_made", norm.membersMade},
         {"needed", analytics::neededPasses(norm)},
         {"pass_rate",
          {{"competent", {competent.passed, competent.members}}, {"others", {others.passed, others.members}}}},
         {"seed", fmt::format("{}", norm.seed)},
         {"use", analytics::useOf(norm)},
         {"checkpoints", Json::array()}};
  for (const analytics::NormCheckpoint& c : norm.checkpoints) {
    j["checkpoints"].push_back({{"checkpoint", c.checkpoint},
                                {"subject", c.subject},
                                {"version", c.version},
                                {"direction", analytics::nameOf(c.direction)},
                                {"log_scale", c.logScale},
                                {"in_rule", c.inRule},
                                {"cut_si", c.cut},
                                {"lower_si", c.lower},
                                {"upper_si", c.upper},
                                {"fixed", analytics::isFixed(c)},
                                {"reason", c.reason}});
    if (c.metric) j["checkpoints"].back()["source_sha256"] = c.metric->sha256;
  }
  return j;
}

void printNorm(const analytics::Norm& norm, std::ostream& out) {
  if (norm.synthetic) out << analytics::watermarkText << '\n';
  for (const std::string& line : analytics::normSummary(norm)) analytics::printWrapped(line, out);
  out << '\n';
  analytics::ReportTable table =
      analytics::tableOf("Pass marks", {"=checkpoint", "=unit", "=better", "cut", "95 %", "=rule", "="});
  table.leastNeeded = {"", "better", "95 %"};
  for (const analytics::NormCheckpoint& c : norm.checkpoints) {
    const analytics::CheckpointDefinition* d =
        c.metric ? &c.metric->definition : analytics::findCheckpoint(c.checkpoint);
    const double factor = d != nullptr ? d->displayFactor : 1.0;
    const auto number = [&](double v) { return analytics::figureNumber(d, v * factor); };
    table.rows.push_back({c.metric ? c.checkpoint + " (external)" : analytics::figureName(c.checkpoint, c.subject),
                          d == nullptr || d->displayUnit == "1" ? "" : d->displayUnit, analytics::nameOf(c.direction),
                          c.cut ? number(*c.cut) : "-",
                          c.lower ? fmt::format("[{}, {}]", number(*c.lower), number(*c.upper)) : "-",
                          c.inRule ? "counts" : "", c.reason});
  }
  analytics::printTable(table, out);
  for (const std::string& warning : analytics::normWarnings(norm)) analytics::printWrapped(warning, out);
  if (norm.synthetic) out << analytics::watermarkText << '\n';
}

void createNorm(NormOptions& o) {
  o.request.name = o.name;
  o.request.by = o.by;
  o.request.leastPassed = minOf(o.rule);
  o.request.seed = std::stoull(o.seed);
  o.request.who.grouping = o.groupBy == "performer" ? analytics::Grouping::performer : analytics::Grouping::group;
  if (!o.attemptRule.empty()) o.request.who.attemptRule = analytics::AttemptRule::first;
  for (const std::string& text : o.fixed) o.request.fixed.push_back(analytics::parseFixedCut(text));
  if (!o.borderline.form.empty()) o.request.borderline = o.borderline;
  if (!o.protocol.empty())
    o.request.who.protocol.emplace().protocol = analytics::readProtocol(findAsset(o.protocol, "protocols", "protocol"));
  Progress progress("Making the norm");
  const analytics::Norm norm =
      analytics::createNorm(o.database, o.request, {}, [&](double share, const char*) { progress.showShare(share); });
  Progress::erase();
  printNorm(norm, std::cout);
}

void listNorms(NormOptions& o) {
  Json rows = Json::array();
  std::string text;
  for (const analytics::Norm& norm : analytics::CohortDatabase(o.database, Access::read).norms()) {
    rows.push_back(normJson(norm));
    const analytics::PassRate own = analytics::passRates(norm).first;
    text += fmt::format("{} version {}, {}: {}, judged by {}{}{}{}\n", norm.name, norm.version, norm.createdUtc,
                        recorder::counted(norm.members.size(), "member"), norm.judgedBy,
                        norm.evidence.empty() ? ", formative" : "", norm.synthetic ? ", SYNTHETIC" : "",
                        own.passed == own.members ? ""
                                                  : fmt::format(", FAILED by {} of its {} competent members",
                                                                own.members - own.passed, own.members));
  }
  printResult(o.json, "norms", {{"norms", rows}}, text.empty() ? "no norms\n" : text);
}

void showNorm(NormOptions& o) {
  const analytics::Norm norm = analytics::CohortDatabase(o.database, Access::read).norm(o.name, o.version);
  printResult(o.json, "norm", normJson(norm), [&](std::ostream& out) { printNorm(norm, out); });
}

void attachEvidence(NormOptions& o) {
  const std::filesystem::path file(o.file);
  const std::string name = file.filename().string();
  const std::string hash = recorder::sha256Hex(recorder::readFileBytes(file, name, maxEvidence));
  analytics::CohortDatabase database(o.database, Access::write);
  const analytics::Norm norm = database.norm(o.name, o.version);
  database.attachEvidence(norm, {o.statement, name, hash, o.by, ""});
  std::cout << analytics::useOf(database.norm(norm.name, norm.version)) << '\n';
}

void addCreateOptions(CLI::App& command, NormOptions& o) {
  analytics::StudyOptions& who = o.request.who;
  command.add_option("--by", o.by, "Person who makes it")->required();
  command.add_option("--rule", o.rule, "How figures combine: all, or at-least:K of them")->required();
  addList(command, "--checkpoints", o.request.checkpoints,
          "Figures in the rule, A,B: a checkpoint, or one of it (\"path-length left\"); all: every one with a mark; "
          "default: time, path lengths, critical view, clip errors, perforations and burns, as far as they have one");
  command
      .add_option("--fixed", o.fixed,
                  "A pass mark that a person sets, in the unit of the tables, such as \"clip-errors<=0\": the figure "
                  "counts by it; may be repeated")
      ->allow_extra_args(false);
  CLI::Option* protocol = command.add_option(
      "--protocol", o.protocol,
      "A study's protocol, a file or the name of one that comes with the program: its groups, the better one, its "
      "criteria and attempt rule");
  addList(command, "--groups", who.groups, "The two groups, A,B");
  command.add_option("--better", who.better, "The competent one of them");
  command.add_option("--judged-by", o.request.judgedBy,
                     "Instead of groups: the form by which raters judged the attempts (competence)");
  CLI::Option* form =
      command.add_option("--borderline", o.borderline.form,
                         "Instead of groups: borderline regression on the raters' scores by this form; needs --mark");
  CLI::Option* mark = command.add_option("--mark", o.borderline.mark, "Score of a borderline attempt, such as 3");
  form->needs(mark);
  mark->needs(form);
  for (const char* other : {"--groups", "--better", "--judged-by", "--protocol"})
    form->excludes(command.get_option(other));
  addChoice(command, "--group-by", o.groupBy, "Property that makes the groups", {"performer", "group"});
  command.add_option("--attempt-rule", o.attemptRule, "The first of a participant's several attempts")
      ->check(oneOf({"first"}));
  command.add_option("--key", who.key, "Only attempts of this comparability key");
  command.add_flag("--include-synthetic", who.includeSynthetic, "Take in what performers made (watermarked)");
  command.add_flag("--include-practice", who.includePractice, "Take in attempts in practice mode");
  command.add_flag("--phases", who.includePhases,
                   "The checkpoints of each phase of the procedure, too (else those that --checkpoints names)");
  for (const char* name : {"--groups", "--better", "--judged-by", "--group-by", "--attempt-rule", "--include-synthetic",
                           "--include-practice"})
    protocol->excludes(command.get_option(name));
  for (const char* name : {"--groups", "--better", "--group-by"})
    command.get_option("--judged-by")->excludes(command.get_option(name));
  command.add_option("--seed", o.seed, "Seed of the bootstrap")->check(wholeNumber)->capture_default_str();
}

}  // namespace

void addNorm(CLI::App& app, Run& run) {
  const auto o = std::make_shared<NormOptions>();
  CLI::App& command =
      addGroup(app, {"norm", "Make and show the norms that attempts are graded against", "calot norm list c.db"});
  const auto add = [&](const CommandText& text, void (*work)(NormOptions&)) {
    CLI::App* sub = addCommand(command, run, text, work, o).first;
    addCohortOption(*sub, o->database)->required();
    return sub;
  };
  CLI::App* made = add({"create", "Make the next version of a norm from attempts of a cohort",
                        "calot norm create c.db clinic --by \"A. Instructor\" --rule at-least:6 --attempt-rule first"},
                       createNorm);
  made->add_option("name", o->name, "Its name")->required();
  addCreateOptions(*made, *o);
  add({"list", "List the norms of a cohort", "calot norm list c.db"}, listNorms)
      ->add_flag("--json", o->json, "Print JSON");
  CLI::App* shown =
      add({"show", "Show a norm: members, rule, pass rate, pass marks", "calot norm show c.db clinic"}, showNorm);
  CLI::App* proven =
      add({"evidence", "Attach the site's validity evidence; without it every sheet is formative",
           "calot norm evidence c.db clinic --file report.pdf --statement \"validated 2026\" --by \"A. Instructor\""},
          attachEvidence);
  for (CLI::App* sub : {shown, proven}) {
    sub->add_option("name", o->name, "Its name")->required();
    sub->add_option("--norm-version", o->version, "Its version; default: the newest");
  }
  const auto [angoff, a] =
      addCommand(command, run,
                 {"angoff", "How many figures a borderline trainee passes, by judges (Angoff), for --rule",
                  "calot norm angoff judges.csv"},
                 judgeByAngoff);
  angoff->add_option("judges", a->table, "CSV file: a column judge, and one of probabilities for each figure")
      ->required();
  addSimilarNames(*angoff, a->similarNames);
  angoff->add_flag("--json", a->json, "Print JSON");
  shown->add_flag("--json", o->json, "Print JSON");
  proven->add_option("--file", o->file, "The document; its name and hash are stored")->required();
  proven->add_option("--statement", o->statement, "Its finding, one sentence")->required();
  proven->add_option("--by", o->by, "Person who attaches it")->required();
}

}  // namespace calot::apps
