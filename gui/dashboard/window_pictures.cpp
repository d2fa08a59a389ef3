// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of the dashboard's pages, for its documentation.
#include <QCoreApplication>
#include <QElapsedTimer>
#include <QEventLoop>
#include <QStackedWidget>
#include <QTabWidget>

#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/attempts_page.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/figure_panel.h"
#include "gui/dashboard/figures_page.h"
#include "gui/dashboard/greeting_page.h"
#include "gui/dashboard/norm_dialog.h"
#include "gui/dashboard/pair_page.h"
#include "gui/dashboard/ratings_page.h"
#include "gui/dashboard/settings.h"
#include "gui/dashboard/study_page.h"
#include "gui/dashboard/trainee_page.h"
#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

constexpr qint64 maxWaiting = 120000;  // ms for a page to have read what it shows
constexpr int settleTime = 1500;       // ms for pictures and animations to be on the screen

void waitFor(const std::function<bool()>& condition) {
  QElapsedTimer clock;
  clock.start();
  // What was wished for a moment ago may not have begun: the condition must hold for a while.
  qint64 since = -1;
  while (clock.elapsed() < maxWaiting && (since < 0 || clock.elapsed() < since + settleTime)) {
    QCoreApplication::processEvents(QEventLoop::AllEvents, 50);
    if (!condition())
      since = -1;
    else if (since < 0)
      since = clock.elapsed();
  }
}

}  // namespace

void DashboardWindow::savePicture(QWidget& page, const QString& file) {
  QCoreApplication::processEvents();
  if (!page.grab().save(file, "PNG"))
    throw Error(ErrorKind::failure, Where{file.toStdString()}, "cannot write the picture; does the folder exist?");
}

void DashboardWindow::savePictures(const QString& folder) {
  const auto save = [&](QWidget* page, const char* name, const std::function<bool()>& ready) {
    if (page != nullptr) tabs_->setCurrentWidget(page);
    waitFor(ready);
    savePicture(*this, folder + '/' + name);
  };
  const auto atOnce = [] { return true; };
  if (stack_->currentWidget() == greeting_) {
    save(nullptr, "greeting.png", atOnce);
    return;
  }
  save(attempts_, "attempts.png", atOnce);
  tabs_->setCurrentWidget(attempt_);
  waitFor([this] { return attempt_->settled(); });
  attempt_->figures().showWorst();
  save(attempt_, "attempt.png", [this] { return attempt_->settled(); });
  save(compare_, "compare.png", [this] { return compare_->ready(); });
  bool studied = false;
  const auto told = connect(study_, &StudyPage::studyShown, this, [&] { studied = true; });
  save(study_, "study.png", [&] { return studied; });
  disconnect(told);
  save(trainee_, "trainee.png", [this] { return trainee_->ready(); });
  tabs_->setCurrentWidget(pair_);
  pair_->chooseTwo();
  waitFor([this] { return pair_->settled(); });
  pair_->showMiddle();
  save(pair_, "pair.png", [this] { return pair_->settled(); });
  rating_->chooseForm("goals");
  save(rating_, "ratings.png", [this] { return rating_->settled(); });
  NormDialog norm(document_, {}, this);
  norm.show();
  waitFor(atOnce);
  savePicture(norm, folder + "/norm.png");
  norm.hide();
  SettingsDialog settings(this);
  settings.show();
  waitFor(atOnce);
  savePicture(settings, folder + "/settings.png");
}

}  // namespace calot::gui
