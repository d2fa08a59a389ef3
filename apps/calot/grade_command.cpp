// SPDX-License-Identifier: GPL-3.0-or-later
// calot grade: one attempt against a norm, as a sheet.

#include <algorithm>

#include "analytics/assessment/grade.h"
#include "analytics/checkpoints/replay_words.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/attempt_sheet.h"
#include "analytics/report/grade_sheet.h"
#include "apps/calot/command.h"
#include "apps/calot/study_command.h"
#include "gui/moments/moments.h"
#include "recorder/base/files.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::apps {
namespace {

namespace fs = std::filesystem;
using Access = analytics::CohortDatabase::Access;

struct GradeOptions {
  std::string database, attempt, norm, recording, html, pdf;
  unsigned version = 0;
  bool mixKeys = false, withReplay = false, json = false, force = false;
};

/// The named norm, or the only one that there is.
analytics::Norm normOf(const analytics::CohortDatabase& database, const GradeOptions& o) {
  if (!o.norm.empty()) return database.norm(o.norm, o.version);
  std::vector<analytics::Norm> norms = database.norms();
  if (norms.empty())
    throw Error(ErrorKind::refused,
                fmt::format("{}: there is no norm yet; make one with calot norm create", o.database));
  if (std::any_of(norms.begin(), norms.end(), [&](const auto& n) { return n.name != norms[0].name; }))
    throw Error(ErrorKind::invalid, "grade: there are several norms; name one with --norm");
  return database.norm(norms[0].name, o.version);
}

/// The recording that was named, or the one beside the database; empty where there is none.
fs::path recordingOf(const analytics::AttemptRow& attempt, const GradeOptions& o) {
  if (!o.recording.empty()) return o.recording;
  std::error_code ignored;
  const fs::path beside = fs::path(o.database).parent_path() / attempt.fileName;
  return fs::is_regular_file(beside, ignored) && beside.extension() == ".h5" ? beside : fs::path();
}

/// Pictures of the gravest moments, as a sheet shows them.
std::vector<analytics::Picture> picturesOf(const analytics::Grade& grade,
                                           const std::vector<analytics::FigureMoments>& figures, const fs::path& file,
                                           Progress& progress) {
  const std::vector<analytics::SheetMoment> moments = analytics::worstMoments(grade.errors, figures, &grade);
  progress.next("Drawing moments", "pictures");
  return gui::sheetPictures(file, moments, [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
}

/// Finds the moments of the grade. @return pictures of the gravest, where `draw` asks for them
std::vector<analytics::Picture> lookAtRecording(analytics::Grade& grade, const fs::path& file, bool draw,
                                                Progress& progress) {
  const auto figures = analytics::weakFigures(grade);
  if (file.empty()) {
    if (figures.empty() && !draw && !(grade.criticalErrors.value_or(0.0) > 0.0)) return {};
    grade.momentsMissing =
        fmt::format("the recording {} is not beside the database: name it with --recording", grade.attempt.fileName);
    return {};
  }
  if (const recorder::ChainVerdict chain = recorder::probe(file); !chain.intact())
    throw Error(ErrorKind::refused, Where{file.string()},
                fmt::format("its content chain is broken ({})", analytics::wordsFor(chain)));
  recorder::Recording recording(file);
  if (recording.header().attempt != grade.attempt.uuid)
    throw Error(ErrorKind::refused, Where{file.string()},
                fmt::format("is of attempt {}, not {}", recording.header().attempt, grade.attempt.uuid));
  if (recording.header().purpose == "golden") {
    grade.momentsMissing = "a golden recording holds no results of its steps";
    return {};
  }
  progress.next("Looking for moments", "steps");
  analytics::AttemptMoments found = analytics::findMoments(
      recording, figures, [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
  const std::vector<analytics::FigureMoments> moments = found.figures;
  analytics::addMoments(grade, std::move(found));
  if (!draw) return {};
  return picturesOf(grade, moments, file, progress);
}

/// The bytes of the attempt's recording.
std::vector<std::byte> carriedRecording(const analytics::AttemptRow& attempt, const fs::path& file) {
  constexpr std::size_t most = std::size_t{512} << 20U;  // what a browser still opens as one page
  if (file.empty())
    throw Error(ErrorKind::damaged,
                fmt::format("the recording {} is not beside the database: name it with --recording", attempt.fileName));
  if (recorder::Recording(file).header().attempt != attempt.uuid)
    throw Error(ErrorKind::refused, Where{file.string()}, fmt::format("is not of attempt {}", attempt.uuid));
  return recorder::readFileBytes(file, file.string(), most);
}

void grade(const GradeOptions& o) {
  if (o.withReplay && o.html.empty())
    throw Error(ErrorKind::invalid, "--with-replay needs a page: name one with --html");

  for (const std::string& file : {o.html, o.pdf}) {
    if (!file.empty()) recorder::refuseOutput(file, o.force);
  }
  Progress progress("Grading", o.json);
  analytics::refuseUnsound(o.database);
  const analytics::CohortDatabase cohort(o.database, Access::read);
  const std::vector<analytics::AttemptRow> attempts = cohort.listAttempts();
  const analytics::AttemptRow attempt = *cohort.attempt(cohort.attemptNamed(o.attempt));
  const analytics::Norm norm = normOf(cohort, o);
  analytics::Grade result = analytics::gradeAttempt(attempt, attempts, cohort.allValues(), norm, o.mixKeys, o.database);
  const fs::path recording = recordingOf(attempt, o);
  analytics::AttemptSheet sheet{attempt, cohort.values(attempt.uuid), &result, {}, {}, {}};
  sheet.pictures = lookAtRecording(result, recording, !o.html.empty() || !o.pdf.empty(), progress);
  sheet.picturesMissing = result.momentsMissing;
  const std::string name = recording.filename().string();
  sheet.recording = name;
  sheet.howToDraw = fmt::format("calot render {} --at SECONDS -o F.png draws a moment.", name);
  const std::vector<std::byte> carried = o.withReplay ? carriedRecording(attempt, recording) : std::vector<std::byte>{};
  const analytics::CarriedRecording inPage{name, carried};
  if (!o.html.empty() || !o.pdf.empty())
    writeReport(analytics::sheetDocument(sheet), o.html, o.pdf, o.force, o.withReplay ? &inPage : nullptr);
  printResult(o.json, "grade", analytics::gradeTree(result),
              [&](std::ostream& out) { analytics::printGrade(result, out); });
}

}  // namespace

void addGrade(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(
      app, run, {"grade", "Hold an attempt against a norm", "calot grade c.db --attempt 3f2a --html sheet.html"},
      grade);
  addCohortOption(*command, o->database)->required();
  command->add_option("--attempt", o->attempt, "Its uuid, or how that begins")->required();
  command->add_option("--norm", o->norm, "The norm; not needed where there is one alone");
  command->add_option("--norm-version", o->version, "Its version; default: the newest");
  command->add_option(
      "--recording", o->recording,
      "The attempt's recording, for the moments of weak figures; default: the file beside the database");
  command->add_flag("--mix-keys", o->mixKeys, "Compare across scenes, devices and versions, and say so");
  command->add_option("--html", o->html, "Write the sheet as one self-contained page");
  command->add_flag("--with-replay", o->withReplay, "The page carries the recording, for calot-page.html to play");
  command->add_option("--pdf", o->pdf, "Write the sheet on A4 pages");
  command->add_flag("--json", o->json, "Print JSON");
  command->add_flag("--force", o->force, "Replace files that are there");
}

}  // namespace calot::apps
