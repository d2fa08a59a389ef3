// SPDX-License-Identifier: GPL-3.0-or-later
// calot protocol: checks a study's protocol, registers it in a cohort, lists what is registered.

#include <algorithm>
#include <set>
#include <span>

#include "analytics/assessment/protocol.h"
#include "analytics/cohort/blinding.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/study_protocol.h"
#include "analytics/statistics/two_groups.h"
#include "apps/calot/command.h"
#include "apps/calot/study_command.h"
#include "recorder/base/counted.h"
#include "recorder/formats/scene_file.h"

namespace calot::apps {
namespace {

using Access = analytics::CohortDatabase::Access;

struct ProtocolOptions {
  std::string protocol, database, by, reason;
  std::vector<std::string> scenes;  ///< files of the user's own
  StudySource study;                ///< choices beside the protocol
  bool json = false;
};

/// A hypothesis on an organ that the scene has not. @throws Error (damaged)
void checkOrgans(const analytics::Protocol& p, const SceneDescription& scene) {
  std::set<std::string> known;
  for (const auto& organ : scene.organs) known.insert(organ.name);
  for (const auto& vessel : scene.vessels) known.insert(vessel.name);
  for (const auto& fat : scene.fat) known.insert(fat.name);
  for (std::size_t i = 0; i < p.hypotheses.size(); ++i) {
    const analytics::CheckpointDefinition* const d = analytics::findCheckpoint(p.hypotheses[i].checkpoint);
    if (d != nullptr && d->aggregation == analytics::Aggregation::organ && known.count(p.hypotheses[i].subject) == 0)
      throw Error(ErrorKind::damaged, Where{p.file, fmt::format("/hypotheses/{}/subject", i)},
                  fmt::format("scene {} has: {}", p.scene, fmt::join(known, ", ")));
  }
}

/// Holds a protocol against this program, and against the cohort where there is one. Its scene is one of the program's,
/// of `--scene`, of the cohort's attempts, or a task of imported motion ("TASK/0"). A group may yet come: a warning.
/// @throws Error (damaged)
analytics::Protocol checkedProtocol(const ProtocolOptions& o) {
  analytics::Protocol p = analytics::readProtocol(findAsset(o.protocol, "protocols", "protocol"));
  std::set<std::string> scenes, groups;
  if (!o.database.empty() && std::filesystem::exists(o.database)) {
    const analytics::CohortDatabase database(o.database, Access::read);
    for (const analytics::AttemptRow& a : database.listAttempts()) {
      scenes.insert(fmt::format("{}/{}", a.scene, a.sceneMajor));
      groups.insert(p.performers ? a.profile : a.group);
    }
    for (const analytics::Participant& person : database.participants())
      groups.insert(p.performers ? "" : person.group);
    groups.erase("");
  }
  std::vector<std::filesystem::path> files = recorder::listScenes(assetFolders());
  for (const std::string& scene : o.scenes) files.push_back(recorder::findScene(scene, assetFolders()));
  for (std::size_t i = 0; i < files.size() && !p.scene.empty(); ++i) {
    const SceneDescription scene = recorder::loadScene(files[i]).description;
    scenes.insert(fmt::format("{}/{}", scene.name, scene.majorVersion));
    if (p.scene == fmt::format("{}/{}", scene.name, scene.majorVersion)) checkOrgans(p, scene);
  }
  if (!p.scene.empty() && !p.scene.ends_with("/0") && scenes.count(p.scene) == 0) {
    throw Error(ErrorKind::damaged, Where{p.file, "/scene"},
                fmt::format("there is no scene \"{}\" (there are: {}); --scene names a file of your own", p.scene,
                            fmt::join(scenes, ", ")));
  }
  for (const analytics::Population& population : p.populations) {
    if (!groups.empty() && groups.count(population.group) == 0)
      fmt::print(stderr, "calot: warning: {}: nobody in {} is of group \"{}\" yet (there are: {})\n", p.file,
                 o.database, population.group, fmt::join(groups, ", "));
  }
  return p;
}

void checkProtocol(const ProtocolOptions& o) {
  const analytics::Protocol p = checkedProtocol(o);
  const auto primary = std::count_if(p.hypotheses.begin(), p.hypotheses.end(), [](const auto& h) { return h.primary; });
  fmt::print("{}: protocol {} version {}, {} hypotheses, {} of them primary, SHA-256 {}\n", p.file, p.name, p.version,
             p.hypotheses.size(), primary, p.sha256);
  const double mark = p.level / static_cast<double>(primary);
  const std::size_t least = analytics::leastGroups(mark);
  fmt::print(
      "Support of any primary hypothesis needs p <= {:.3g} ({:g}, Holm over {}). Groups of {} and {} are the smallest "
      "equal ones that can reach it (smallest p {:.2g}, without ties); smaller ones can support none.\n",
      mark, p.level, primary, least, least, analytics::smallestRankTestP(least, least));
}

void registerProtocol(const ProtocolOptions& o) {
  const analytics::Protocol p = checkedProtocol(o);
  analytics::CohortDatabase database(o.database, Access::create);
  bool added = false;
  const analytics::RegisteredProtocol stored =
      database.registerProtocol({p.name, p.version, p.sha256, p.text}, o.by, added);
  fmt::print("{}: protocol {} version {} {} {} by {}, SHA-256 {}\n", o.database, stored.name, stored.version,
             added ? "registered on" : "was registered on", stored.registeredUtc, stored.by, stored.sha256);
}

/// Only before there are attempts that it is about.
void withdrawProtocol(const ProtocolOptions& o) {
  analytics::CohortDatabase database(o.database, Access::write);
  std::string why = "is not registered here (calot protocol list)";
  for (const analytics::RegisteredProtocol& r : database.protocols()) {
    const std::string name = fmt::format("{}/{}", r.name, r.version);
    if (name != o.protocol) continue;
    const analytics::Protocol p = analytics::parseProtocol(std::as_bytes(std::span(r.text)), name);
    const std::size_t data = analytics::attemptsUnder(p, database.listAttempts());
    why = !r.withdrawnUtc.empty()                             ? "was withdrawn on " + r.withdrawnUtc
          : analytics::readAnalysisLock(o.database, r.sha256) ? "has an analysis that is locked"
          : data > 0 ? fmt::format("has data, {} of its groups", recorder::counted(data, "attempt"))
                     : "";
    if (!why.empty()) break;
    database.withdrawProtocol(r.sha256, o.reason, o.by);
    fmt::print("{}: protocol {} withdrawn; a new one has a higher version or another name\n", o.database, name);
    return;
  }
  throw Error(ErrorKind::refused, Where{o.database}, fmt::format("protocol {} {}", o.protocol, why));
}

void lockAnalysis(const ProtocolOptions& o) {
  const analytics::CohortDatabase cohort(o.database, Access::read);
  StudySource source = o.study;
  source.protocol = o.protocol;
  const analytics::StudyOptions options = protocolStudyOptions(source, cohort);
  const analytics::Protocol& protocol = options.protocol->protocol;
  const auto& registered = options.protocol->registered;
  if (std::none_of(registered.begin(), registered.end(),
                   [&](const auto& r) { return r.sha256 == protocol.sha256 && r.withdrawnUtc.empty(); })) {
    throw Error(ErrorKind::refused, Where{o.database},
                fmt::format("protocol {} version {} is not registered here with this text; register it first (calot "
                            "protocol register)",
                            protocol.name, protocol.version));
  }
  // An analysis that the study would refuse cannot be locked.
  static_cast<void>(analytics::makeMaskedStudy(cohort, options, false));
  analytics::AnalysisLock present = analytics::presentAnalysis(cohort, options);
  present.by = o.by;
  bool added = false;
  const analytics::AnalysisLock stored = analytics::storeAnalysisLock(o.database, present, added);
  fmt::print("{}: analysis of protocol {} {} {} by {}, values SHA-256 {}\n", o.database, stored.protocol,
             added ? "locked on" : "was locked on", stored.lockedUtc, stored.by, stored.valuesSha256);
}

/// Those that come with the program.
void listShipped(const ProtocolOptions& o) {
  Json rows = Json::array();
  std::string text;
  for (const std::filesystem::path& file : listAssets("protocols")) {
    const analytics::Protocol p = analytics::readProtocol(file);
    rows.push_back({{"name", p.name}, {"version", p.version}, {"sha256", p.sha256}, {"title", p.title}});
    text += wrappedText(fmt::format("{} version {}: {}\nSHA-256 {}", p.name, p.version, p.title, p.sha256),
                        terminalColumns(), 2) +
            '\n';
  }
  printResult(o.json, "protocols", {{"protocols", rows}},
              text.empty() ? "no protocols (CALOT_ASSETS names the folder that has them)\n" : text);
}

void listProtocols(const ProtocolOptions& o) {
  if (o.database.empty()) return listShipped(o);
  Json rows = Json::array();
  std::string text;
  for (const auto& p : analytics::CohortDatabase(o.database, Access::read).protocols()) {
    rows.push_back({{"name", p.name},
                    {"version", p.version},
                    {"sha256", p.sha256},
                    {"registered_utc", p.registeredUtc},
                    {"by", p.by},
                    {"withdrawn_utc", p.withdrawnUtc}});
    text += fmt::format("{} version {}, registered on {} by {}{}, SHA-256 {}\n", p.name, p.version, p.registeredUtc,
                        p.by, p.withdrawnUtc.empty() ? "" : ", withdrawn on " + p.withdrawnUtc, p.sha256);
  }
  printResult(o.json, "protocols", {{"protocols", rows}}, text.empty() ? "no protocols\n" : text);
}

}  // namespace

void addProtocol(CLI::App& app, Run& run) {
  const auto o = std::make_shared<ProtocolOptions>();
  CLI::App& command = addGroup(
      app, {"protocol", "Check, register, withdraw, lock and list the protocols of studies", "calot protocol list"});
  const auto add = [&](const CommandText& text, void (*work)(const ProtocolOptions&)) {
    return addCommand(command, run, text, work, o).first;
  };
  const char* file = "A protocol's JSON file, or the name of one that comes with the program";
  CLI::App* checked =
      add({"check", "Read a protocol and say what it holds", "calot protocol check my-protocol.json"}, checkProtocol);
  checked->add_option("protocol", o->protocol, file)->required();
  addCohortOption(*checked, o->database, "Cohort whose groups and scenes it is held against");
  CLI::App* registered = add({"register", "Store a protocol with its hash and the time of now",
                              "calot protocol register my-protocol.json c.db --by \"A. Instructor\""},
                             registerProtocol);
  registered->add_option("protocol", o->protocol, file)->required();
  addCohortOption(*registered, o->database, "Cohort database; made where there is none")->required();
  registered->add_option("--by", o->by, "Person who registers it")->required();
  for (CLI::App* known : {checked, registered})
    known->add_option("--scene", o->scenes, "Scene file of your own; may be repeated")->allow_extra_args(false);
  CLI::App* withdrawn =
      add({"withdraw", "Withdraw a registered protocol that has no data yet; the audit notes it",
           "calot protocol withdraw my-protocol/1 c.db --by \"A. Instructor\" --reason \"names an old scene\""},
          withdrawProtocol);
  withdrawn->add_option("protocol", o->protocol, "Name and version, NAME/VERSION")->required();
  addCohortOption(*withdrawn, o->database)->required();
  withdrawn->add_option("--by", o->by, "Person who withdraws it")->required();
  withdrawn->add_option("--reason", o->reason, "Reason")->required();
  CLI::App* locked = add({"lock", "Fix a study's analysis, after which its groups are named",
                          "calot protocol lock my-protocol.json c.db --by \"A. Analyst\""},
                         lockAnalysis);
  locked->add_option("protocol", o->protocol, file)->required();
  addCohortOption(*locked, o->database)->required();
  locked->add_option("--by", o->by, "Person who locks it")->required();
  locked->add_option("--cohort-name", o->study.cohortName, "As the study's option of this name");
  locked->add_option("--key", o->study.cohort.key, "As the study's option of this name");
  locked->add_flag("--mix-keys", o->study.cohort.mixKeys, "As the study's option of this name");
  locked->add_flag("--phases", o->study.cohort.includePhases, "As the study's option of this name");
  CLI::App* listed = add({"list", "List the protocols that a cohort holds, or those that come with the program",
                          "calot protocol list c.db"},
                         listProtocols);
  addCohortOption(*listed, o->database, "Cohort database (default: the protocols that come with the program)");
  listed->add_flag("--json", o->json, "Print JSON");
}

}  // namespace calot::apps
