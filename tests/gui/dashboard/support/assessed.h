// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <QTabWidget>
#include <QTemporaryDir>
#include <QWidget>

#include "gui/dashboard/attempt_page.h"
#include "gui/dashboard/dashboard_window.h"

namespace calot::gui::test {

inline constexpr int patience = 120000;  // ms

/// Two recordings of a performer, one.h5 and two.h5, assessed into c.db by the real program: made once for all tests of
/// a process; each test has a copy, and the dashboard's settings as they are at first.
class AssessedCohort : public ::testing::Test {
 protected:
  void SetUp() override;

  [[nodiscard]] QString file(const char* name) const { return folder_.filePath(name); }
  template <class T>
  static T* child(const QWidget& window, const char* name) {
    T* const found = window.findChild<T*>(name);
    EXPECT_NE(found, nullptr) << name;
    return found;
  }
  /// @param number of the page, from 1
  static void showPage(DashboardWindow& window, int number);
  /// The attempt's page, when what it shows has come.
  static AttemptPage& openAttempt(DashboardWindow& window);

  QTemporaryDir folder_;
  std::filesystem::path root_;
};

}  // namespace calot::gui::test
