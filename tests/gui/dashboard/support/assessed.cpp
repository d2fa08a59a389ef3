// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/gui/dashboard/support/assessed.h"

#include <cstdlib>
#include <QTest>
#include <string>

#include "gui/dashboard/dialogs.h"
#include "tests/gui/dashboard/support/recorded.h"

namespace calot::gui::test {

namespace fs = std::filesystem;

namespace {

struct Assessed {
  QTemporaryDir folder;
  fs::path root = folder.path().toStdString();
  Assessed() {
    startApplication();
    recordPerformer(root / "one.h5", 3.0, 3);
    recordPerformer(root / "two.h5", 2.4, 5);
    const std::string command = std::string(CALOT_PROGRAM) + " assess " + (root / "one.h5").string() + ' ' +
                                (root / "two.h5").string() + " --cohort " + (root / "c.db").string() + " > /dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0);
  }
};

}  // namespace

void AssessedCohort::SetUp() {
  static const Assessed assessed;
  settings::setRecordingFolders({});
  settings::setCalotProgram(CALOT_PROGRAM);
  settings::setPerson({});
  settings::setHiddenColumns({});
  root_ = folder_.path().toStdString();
  for (const char* name : {"one.h5", "two.h5", "c.db"}) fs::copy_file(assessed.root / name, root_ / name);
}

void AssessedCohort::showPage(DashboardWindow& window, int number) {
  window.findChild<QTabWidget*>()->setCurrentIndex(number - 1);
}

AttemptPage& AssessedCohort::openAttempt(DashboardWindow& window) {
  showPage(window, 2);
  AttemptPage& page = *window.findChild<AttemptPage*>();
  EXPECT_TRUE(QTest::qWaitFor([&] { return page.settled(); }, patience));
  return page;
}

}  // namespace calot::gui::test
