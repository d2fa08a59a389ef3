// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot-trainer/pictures.h"

#include <functional>
#include <QApplication>
#include <QDeadlineTimer>
#include <utility>

#include "gui/trainer/end_page.h"
#include "gui/trainer/operation_view.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

/// Lets the window live until `there`, or so many seconds are over. @returns there()
bool waitFor(const std::function<bool()>& there, int seconds) {
  const QDeadlineTimer limit(1000LL * seconds);
  while (!there() && !limit.hasExpired()) QApplication::processEvents(QEventLoop::WaitForMoreEvents, 20);
  return there();
}

}  // namespace

void takePictures(gui::TrainerWindow& window, std::optional<recorder::LoadedScene> scene, const std::string& folder) {
  const auto save = [&](const char* name) {
    window.refresh();
    window.savePicture(QString::fromStdString(folder + "/" + name + ".png"));
  };
  const auto wanted = [](bool there, const char* what) {
    if (!there) throw Error(ErrorKind::failure, std::string("--pictures: ") + what);
  };
  window.chooseScene();
  waitFor([] { return false; }, 1);  // the history is being read
  save("greeting");
  if (!scene) return;
  const auto status = [&] { return window.session()->status(); };
  const auto runs = [&] {
    const quint64 shown = window.view()->shown();
    return waitFor([&] { return status().figures.time > 4.0 && window.view()->shown() > shown + 10; }, 240);
  };
  window.begin(*scene, gui::TrainerWindow::Purpose::controls);
  wanted(runs(), "nothing is running");
  save("controls");
  window.begin(std::move(*scene));
  wanted(runs(), "nothing is running");
  save("running");
  waitFor([&] { return !status().figures.mistakes->empty(); }, 60);
  waitFor([] { return false; }, 1);  // what comes of it
  if (window.session()->pause()) {
    waitFor([] { return false; }, 1);  // the last pictures are still being drawn
    save("paused");
    window.session()->resume();
  }
  window.session()->finish();
  wanted(waitFor([&] { return status().stage == gui::Stage::ended; }, 30), "the attempt does not end");
  window.refresh();
  waitFor([&] { return window.endPage()->replay().isOpen() && window.endPage()->settled(); }, 240);
  save("end");
}

}  // namespace calot::apps
