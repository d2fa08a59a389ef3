// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/norm_dialog.h"

#include <gtest/gtest.h>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QSpinBox>
#include <QTableWidget>
#include <QTemporaryDir>
#include <QTest>
#include <QUndoStack>

#include <memory>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "apps/calot-dashboard/assess_program.h"
#include "gui/dashboard/dashboard_window.h"
#include "gui/dashboard/mark_slider.h"
#include "gui/dashboard/norm_marks.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using Access = analytics::CohortDatabase::Access;
constexpr int normPatience = 120000;  // ms

/// Skilled ones have shorter paths than unskilled ones, and nobody perforates; all are synthetic, in practice mode.
class NormDialogs : public ::testing::Test {
 protected:
  void SetUp() override {
    test::startApplication();
    path_ = folder_.filePath("c.db").toStdString();
    analytics::CohortDatabase database(path_, Access::create);
    for (int i = 0; i < 20; ++i) {
      database.storeAttempt(test::attemptNumber(i),
                            {test::pathLength("left", 0.1 + 0.01 * i + 0.4 * (i % 2)),
                             analytics::makeValue(*analytics::findCheckpoint("clip-errors"), "",
                                                  analytics::Origin::resimulated, i == 19 ? 2.0 : 0.0)});
    }
  }
  [[nodiscard]] std::vector<std::string> uuids(int count) const {
    std::vector<std::string> uuids;
    for (int i = 0; i < count; ++i) uuids.push_back(test::attemptNumber(i).uuid);
    return uuids;
  }
  void open(const std::vector<std::string>& selected = {}) {
    dialog_ = std::make_unique<NormDialog>(std::make_shared<const CohortDocument>(path_), selected);
    part<QLineEdit>("norm-name")->setText("clinic");
    part<QLineEdit>("norm-by")->setText("me");
    dialog_->show();
    settle();
  }
  void settle() {
    ASSERT_TRUE(QTest::qWaitFor([&] { return dialog_->settled(); }, normPatience));
  }
  template <class T>
  T* part(const char* name) {
    T* const found = dialog_->findChild<T*>(name);
    EXPECT_NE(found, nullptr) << name;
    return found;
  }
  NormMark& mark(const char* figure) { return *part<NormMark>((std::string("mark-") + figure).c_str()); }
  QTableWidgetItem* member(int row, int column) { return part<QTableWidget>("norm-members")->item(row, column); }
  std::string noted(const char* field) {
    return part<QLabel>((std::string("norm-") + field + "-note").c_str())->text().toStdString();
  }
  bool canMake() { return part<QPushButton>("norm-make")->isEnabled(); }
  QString make(bool good = true) {
    QSignalSpy made(&*dialog_, &NormDialog::made), refused(&*dialog_, &NormDialog::refused);
    part<QPushButton>("norm-make")->click();
    EXPECT_FALSE(canMake()) << "one at a time";
    EXPECT_TRUE(QTest::qWaitFor([&] { return made.count() + refused.count() > 0; }, normPatience));
    EXPECT_EQ(made.count(), good ? 1 : 0) << part<QLabel>("norm-result")->text().toStdString();
    return part<QLabel>("norm-result")->text();
  }
  [[nodiscard]] std::vector<analytics::Norm> norms() const {
    return analytics::CohortDatabase(path_, Access::read).norms();
  }

  QTemporaryDir folder_;
  std::string path_;
  std::unique_ptr<NormDialog> dialog_;
};

TEST_F(NormDialogs, ANormIsMadeAndWhatItLetsThroughIsSaid) {
  open();
  EXPECT_TRUE(canMake());
  const QString text = make();
  ASSERT_EQ(norms().size(), 1U);
  const analytics::Norm norm = norms().front();
  EXPECT_EQ(norm.name, "clinic");
  EXPECT_EQ(norm.by, "me");
  EXPECT_EQ(norm.members.size(), 20U);
  EXPECT_EQ(norm.judgedBy, "performers skilled against unskilled");
  EXPECT_TRUE(norm.synthetic);
  ASSERT_EQ(norm.checkpoints.size(), 2U);
  EXPECT_EQ(analytics::figuresInRule(norm), 1U) << "clip errors have no spread";
  EXPECT_TRUE(text.startsWith("SYNTHETIC"));
  EXPECT_TRUE(text.contains("Norm clinic version 1"));
  EXPECT_TRUE(text.contains("of 10 competent members pass")) << text.toStdString();
  EXPECT_TRUE(text.contains("FORMATIVE")) << "what it may be used for";
  expectHolds(noted("name"), {"2"});
  EXPECT_TRUE(make().contains("version 2")) << "the same name again";
}

TEST_F(NormDialogs, OfThoseThatAreSelected) {
  open(uuids(12));
  EXPECT_EQ(part<QComboBox>("norm-attempts")->currentIndex(), 1);
  EXPECT_EQ(part<QTableWidget>("norm-members")->rowCount(), 12);
  (void)make();
  EXPECT_EQ(norms().front().members.size(), 12U);
  part<QComboBox>("norm-attempts")->setCurrentIndex(0);
  settle();
  (void)make();
  EXPECT_EQ(norms().back().members.size(), 20U);
}

TEST_F(NormDialogs, FaultsStandBesideTheirFields) {
  open(uuids(4));
  EXPECT_FALSE(canMake());
  expectHolds(noted("members"), {"2", "3"});
  part<QComboBox>("norm-attempts")->setCurrentIndex(0);
  settle();
  EXPECT_TRUE(canMake());
  EXPECT_EQ(noted("members"), "");
  for (const char* name : {"", "two words"}) {
    part<QLineEdit>("norm-name")->setText(name);
    EXPECT_FALSE(noted("name").empty()) << name;
    EXPECT_FALSE(canMake()) << name;
  }
  part<QLineEdit>("norm-name")->setText("clinic");
  EXPECT_EQ(noted("name"), "");
  part<QLineEdit>("norm-by")->clear();
  EXPECT_FALSE(noted("by").empty() || canMake()) << "nobody makes it";
  part<QLineEdit>("norm-by")->setText("me");
  part<QComboBox>("norm-rule")->setCurrentIndex(1);
  part<QSpinBox>("norm-least")->setValue(2);
  settle();
  expectHolds(noted("rule"), {"1"});
  EXPECT_FALSE(canMake());
  part<QComboBox>("norm-rule")->setCurrentIndex(0);
  part<QCheckBox>("norm-synthetic")->setChecked(false);
  settle();
  EXPECT_FALSE(noted("groups").empty()) << "nobody is left";
  EXPECT_FALSE(canMake());
  part<QCheckBox>("norm-synthetic")->setChecked(true);
  settle();
  EXPECT_EQ(noted("groups"), "");
  mark("path-length left").findChild<QCheckBox*>("mark-counts")->click();
  settle();
  EXPECT_FALSE(noted("figures").empty() || canMake()) << "nothing counts";
  EXPECT_TRUE(norms().empty());
}

TEST_F(NormDialogs, TicksSayWhoIsInItAndWhoIsCompetent) {
  open();
  QTableWidget* const list = part<QTableWidget>("norm-members");
  EXPECT_EQ(member(0, 1)->checkState(), Qt::Checked);
  EXPECT_EQ(member(19, 1)->checkState(), Qt::Unchecked);
  EXPECT_EQ(member(0, 2)->text(), "yes");
  EXPECT_EQ(member(19, 2)->text(), "no");
  const QString before = part<QLabel>("norm-outcome")->text();
  list->setFocus();
  list->setCurrentCell(0, 1);
  QTest::keyClick(list, Qt::Key_Space);
  EXPECT_EQ(member(0, 1)->checkState(), Qt::Unchecked);
  list->setCurrentCell(19, 0);
  QTest::keyClick(list, Qt::Key_Space);
  settle();
  EXPECT_NE(member(19, 2)->text(), "no");
  const QString after = part<QLabel>("norm-outcome")->text();
  EXPECT_NE(before, after);
  expectHolds(after.toStdString(), {"9", "10"});
  (void)make();
  const analytics::Norm norm = norms().front();
  EXPECT_EQ(analytics::sidesOf(norm), std::pair(std::size_t{9}, std::size_t{10}));
  expectHolds(norm.judgedBy, {"2 of 20", "me"});
}

TEST_F(NormDialogs, AMarkIsMovedByTheKeyboardAndIsThenAVeto) {
  open();
  NormMark& path = mark("path-length left");
  MarkSlider& slider = path.slider();
  const double computed = *slider.view().mark;
  slider.setFocus();
  QTest::keyClick(&slider, Qt::Key_Home);
  settle();
  EXPECT_LT(*slider.view().mark, 100.0) << "mm, below all values";
  EXPECT_DOUBLE_EQ(*slider.view().before, computed);
  EXPECT_TRUE(path.findChild<QCheckBox*>("mark-veto")->isChecked());
  expectHolds(part<QLabel>("norm-outcome")->text().toStdString(), {"0 of 10"});
  QTest::keyClick(&slider, Qt::Key_PageUp);
  QTest::keyClick(&slider, Qt::Key_PageUp);
  QTest::keyClick(&slider, Qt::Key_Right);
  settle();
  const double set = *slider.view().mark;
  (void)make();
  const analytics::Norm norm = norms().front();
  for (const analytics::NormCheckpoint& c : norm.checkpoints) {
    if (c.checkpoint != "path-length") continue;
    EXPECT_TRUE(c.inRule && analytics::isFixed(c));
    EXPECT_NEAR(*c.cut, set / 1000.0, 1e-12);
    expectHolds(c.reason, {"me"});
  }
  path.findChild<QCheckBox*>("mark-veto")->click();
  settle();
  EXPECT_DOUBLE_EQ(*slider.view().mark, computed) << "the members' mark again";
  EXPECT_FALSE(slider.view().before);
}

TEST_F(NormDialogs, AFigureWithoutSpreadGetsAMarkByHand) {
  open();
  NormMark& clips = mark("clip-errors");
  auto* const counts = clips.findChild<QCheckBox*>("mark-counts");
  EXPECT_FALSE(counts->isChecked() || clips.slider().view().mark);
  EXPECT_FALSE(clips.findChild<QLabel*>("mark-reason")->text().isEmpty()) << "why there is none";
  counts->click();
  settle();
  EXPECT_DOUBLE_EQ(*clips.slider().view().mark, 0.0) << "as the competent do";
  (void)make();
  EXPECT_EQ(analytics::figuresInRule(norms().front()), 2U);
}

TEST_F(NormDialogs, WhatIsCancelledStoresNothing) {
  open();
  part<QPushButton>("norm-make")->click();
  part<QPushButton>("work-cancel")->click();
  EXPECT_TRUE(part<QLabel>("norm-result")->text().startsWith("Cancelled"));
  dialog_.reset();
  QTest::qWait(500);
  EXPECT_TRUE(norms().empty());
}

TEST_F(NormDialogs, MakingCanBeUndone) {
  open();
  QSignalSpy undo(&*dialog_, &NormDialog::undoWanted);
  (void)make();
  DashboardWindow window(apps::assessProgram());
  ASSERT_TRUE(window.openDatabase(QString::fromStdString(path_)));
  window.keepNorm(norms().front());
  auto* const stack = window.findChild<QUndoStack*>();
  part<QPushButton>("norm-undo")->click();
  EXPECT_EQ(undo.count(), 1);
  stack->undo();
  EXPECT_TRUE(QTest::qWaitFor([&] { return norms().empty(); }, normPatience));
  stack->redo();
  EXPECT_TRUE(QTest::qWaitFor([&] { return norms().size() == 1; }, normPatience));
  EXPECT_EQ(norms().front().version, 1U);
}

TEST(MarkScales, HoldRoundPlacesAroundTheValues) {
  const MarkScale mm({101.3, 498.0}, false);
  EXPECT_LE(mm.at(0), 101.3);
  EXPECT_GE(mm.at(mm.steps()), 498.0);
  EXPECT_GE(mm.steps(), 100);
  for (int position = 0; position <= mm.steps(); ++position) {
    EXPECT_EQ(mm.nearest(mm.at(position)), position);
    EXPECT_DOUBLE_EQ(mm.at(position), std::round(mm.at(position))) << "whole millimetres";
  }
  const MarkScale counts({0.0, 3.0}, true);
  EXPECT_DOUBLE_EQ(counts.at(0), 0.0);
  EXPECT_DOUBLE_EQ(counts.at(1), 1.0);
  EXPECT_GT(counts.at(counts.steps()), 3.0);
  const MarkScale ratios({0.91, 0.99}, false);
  EXPECT_EQ(ratios.at(ratios.nearest(0.95)), 0.95);
  const MarkScale alike({2.0, 2.0}, false);
  EXPECT_LT(alike.at(0), 2.0);
  EXPECT_GT(alike.at(alike.steps()), 2.0);
}

}  // namespace
}  // namespace calot::gui
