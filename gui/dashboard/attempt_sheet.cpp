// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/attempt_sheet.h"

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <mutex>
#include <QSaveFile>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/check.h"
#include "analytics/report/grade_sheet.h"
#include "gui/attempt/attempt_recording.h"
#include "gui/attempt/figure_text.h"
#include "gui/attempt/replay_player.h"
#include "gui/attempt/summary_panel.h"
#include "gui/render/renderer.h"
#include "gui/report/pdf_report.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

constexpr int pictureWidth = 800, pictureHeight = 600;
constexpr const char* sheetMaker = "calot " CALOT_VERSION;

QString writeSheet(const std::filesystem::path& file, const std::string& bytes) {
  const QString name = QString::fromStdString(file.string());
  QSaveFile out(name);
  if (!out.open(QIODevice::WriteOnly) || out.write(bytes.data(), static_cast<qint64>(bytes.size())) < 0 ||
      !out.commit())
    throw Error(ErrorKind::failure, Where{file.string()}, "cannot be written: " + out.errorString().toStdString());
  return "Written: " + name;
}

/// Waits for the moments that a player reaches, one after the other.
class MomentCatcher {
 public:
  MomentCatcher(const std::filesystem::path& file, const std::string& attempt)
      : player_(file, attempt,
                {[this](auto view, const PlayerPosition& at) { take(std::move(view), at); },
                 [this](const std::string& reason) { fail(reason); }}) {}
  std::shared_ptr<const SceneView> at(double time, const LongWork::Control& control) {
    {
      const std::lock_guard lock(mutex_);
      view_.reset();
      wanted_ = time;
    }
    player_.seek(time);
    std::unique_lock lock(mutex_);
    while (!view_) {
      wake_.wait_for(lock, std::chrono::milliseconds(50));
      if (control.broken()) throw LongWork::Broken{};
      if (!fault_.empty()) throw Error(ErrorKind::failure, fault_);
    }
    return view_;
  }

 private:
  void take(std::shared_ptr<const SceneView> view, const PlayerPosition& at) {
    const std::lock_guard lock(mutex_);
    const double wanted = std::min(wanted_, at.seconds);
    constexpr double step = 0.021;  // s
    if (!at.settled || std::abs(at.time - wanted) > step) return;
    view_ = std::move(view);
    wake_.notify_one();
  }
  void fail(const std::string& reason) {
    const std::lock_guard lock(mutex_);
    fault_ = reason;
    wake_.notify_one();
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  double wanted_ = -1.0;
  std::shared_ptr<const SceneView> view_;
  std::string fault_;
  ReplayPlayer player_;  // last: its thread uses what is above
};

}  // namespace

analytics::ReportDocument attemptDocument(const SheetRequest& request) {
  const analytics::AttemptRow& attempt = request.attempt;
  analytics::ReportDocument document;
  document.title =
      (operatorText(attempt) + ", ").toStdString() + attempt.scene + ", " + startText(attempt.startUtc).toStdString();
  document.synthetic = attempt.synthetic;
  document.add(request.summary.verdict);
  if (!request.summary.criticalView.empty()) document.add(request.summary.criticalView);
  document.add(request.summary.errors);
  std::vector<std::string> figures;
  for (const analytics::KeyFigure& figure : request.summary.figures)
    figures.push_back(keyFigureText(figure).toStdString());
  document.addList(figures);
  analytics::ReportTable table = analytics::tableOf("What went wrong", {"time", "=event"});
  constexpr std::size_t maxRows = 24;
  std::size_t errors = 0;
  for (const TrackEvent& event : request.events) {
    if (event.error && ++errors <= maxRows) table.rows.push_back({timeText(event.time), event.text});
  }
  if (errors > maxRows) table.rows.push_back({"", "and " + std::to_string(errors - maxRows) + " more"});
  if (!table.rows.empty()) document.parts.emplace_back(std::move(table));
  document.add("Attempt " + attempt.uuid + ", " + badgeText(attempt.verification.verdict).toStdString() + ". " +
               analytics::comparabilityWords(attempt.comparabilityKey) + ".");
  return document;
}

std::vector<Image> picturesAt(const std::filesystem::path& recording, const std::string& attempt,
                              const std::vector<WorstMoment>& moments, LongWork::Control& control) {
  std::vector<Image> pictures;
  MomentCatcher catcher(recording, attempt);
  Renderer renderer;
  for (const WorstMoment& moment : moments) {
    control.progress(0.1 + 0.8 * static_cast<double>(pictures.size()) / static_cast<double>(moments.size()),
                     QString("Picture %1 of %2").arg(pictures.size() + 1).arg(moments.size()));
    pictures.push_back(
        renderer.render(*catcher.at(moment.time, control), pictureWidth, pictureHeight, Quality::interactive));
  }
  return pictures;
}

QString writeOnePage(const SheetRequest& request, LongWork::Control& control) {
  control.progress(0.0, "Opening the recording");
  std::vector<CaptionedPicture> pictures;
  if (!request.recording.empty() && !request.moments.empty()) {
    std::vector<Image> drawn = picturesAt(request.recording, request.attempt.uuid, request.moments, control);
    for (std::size_t i = 0; i < drawn.size(); ++i)
      pictures.push_back({std::move(drawn[i]), timeText(request.moments[i].time) + "  " + request.moments[i].caption});
  }
  control.progress(0.9, "Laying out the page");
  const std::string bytes = onePagePdf(attemptDocument(request), pictures, sheetMaker);
  control.progress(1.0, "Writing the page");
  return writeSheet(request.file, bytes);
}

QString writeGradeSheet(const SheetRequest& request, LongWork::Control& control) {
  control.progress(0.0, "Checking the cohort");
  analytics::refuseUnsound(request.database);
  control.progress(0.05, "Reading the cohort");
  const analytics::CohortDatabase cohort(request.database, analytics::CohortDatabase::Access::read);
  const analytics::Norm norm = analytics::AssessmentDatabase(request.database, analytics::CohortDatabase::Access::read)
                                   .norm(request.norm, request.normVersion);
  analytics::Grade grade = analytics::gradeAttempt(request.attempt, cohort.listAttempts(), cohort.allValues(), norm,
                                                   false, request.database);
  const auto weak = analytics::weakFigures(grade);
  if (request.recording.empty()) {
    grade.momentsMissing = "the recording " + request.attempt.fileName + " was not found";
  } else if (!weak.empty()) {
    recorder::Recording recording = openRecording(request.recording, request.attempt.uuid);
    analytics::addMoments(grade, analytics::findMoments(recording, weak, [&](std::uint64_t done, std::uint64_t of) {
                            control.progress(0.1 + 0.8 * static_cast<double>(done) / static_cast<double>(of),
                                             "Looking for moments");
                          }));
  }
  control.progress(0.9, "Laying out the sheet");
  const std::string bytes =
      pdfReport(analytics::gradeDocument(grade, request.recording.filename().string(), {}), sheetMaker);
  control.progress(1.0, "Writing the sheet");
  return writeSheet(request.file, bytes);
}

}  // namespace calot::gui
