// SPDX-License-Identifier: GPL-3.0-or-later
// calot dossier: what a cohort can say for the validity of its judgements, and what it can't.

#include "analytics/interchange/dossier.h"

#include "apps/calot/command.h"
#include "apps/calot/study_command.h"
#include "recorder/base/files.h"
#include "recorder/base/json_reader.h"

namespace calot::apps {
namespace {

struct DossierOptions {
  StudySource source;
  std::vector<std::string> external;
  std::string html, pdf;
  bool json = false, force = false;
};

void dossier(DossierOptions& o) {
  for (const std::string& file : {o.html, o.pdf}) {
    if (!file.empty()) recorder::refuseOutput(file, o.force);
  }
  Progress progress("Computing the dossier", o.json);
  analytics::refuseUnsound(o.source.database);
  const std::filesystem::path asset = findAsset("validity", "dossier", "list of questions");
  const analytics::ValueTree questions = recorder::parseStrictJson(
      recorder::readFileBytes(asset, asset.filename().string(), std::size_t{1} << 20U), asset.filename().string());
  const analytics::CohortDatabase cohort(o.source.database, analytics::CohortDatabase::Access::read);
  const analytics::Dossier made =
      analytics::makeDossier(o.source.database, questions,
                             analytics::dossierFacts(cohort, cohortStudyOptions(o.source, cohort),
                                                     analytics::readSignedFigures(o.external, cohort)));
  writeReport(made.document, o.html, o.pdf, o.force);
  printResult(o.json, "dossier", made.json, [&](std::ostream& out) { analytics::printDocument(made.document, out); });
}

}  // namespace

void addDossier(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"dossier", "State what a cohort holds for the validity of its judgements, and what is missing",
                  "calot dossier c.db --attempt-rule first --better expert --pdf dossier.pdf"},
                 dossier);
  addStudySource(*command, o->source, false);
  command->get_option("--cohort")->required();
  command->add_option("--external", o->external, "Signed figures of another site (calot station sign); may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--json", o->json, "Print JSON");
  command->add_option("--html", o->html, "Write the dossier as one self-contained page");
  command->add_option("--pdf", o->pdf, "Write the dossier on A4 pages");
  command->add_flag("--force", o->force, "Replace files that are there");
}

}  // namespace calot::apps
