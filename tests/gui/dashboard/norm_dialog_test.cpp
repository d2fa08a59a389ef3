// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/dialogs.h"

#include <gtest/gtest.h>
#include <QCheckBox>
#include <QComboBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>

#include <memory>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "tests/gui/dashboard/support/cohort.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using Access = analytics::CohortDatabase::Access;
constexpr int normPatience = 120000;  // ms

/// Skilled ones have shorter paths than unskilled ones; all are synthetic, in practice mode.
class NormDialogs : public ::testing::Test {
 protected:
  void SetUp() override {
    test::startApplication();
    path_ = folder_.filePath("c.db").toStdString();
    analytics::CohortDatabase database(path_, Access::create);
    for (int i = 0; i < 20; ++i)
      database.storeAttempt(test::attemptNumber(i), {test::pathLength("left", 0.1 + 0.01 * i + 0.4 * (i % 2))});
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
  }
  template <class T>
  T* part(const char* name) {
    T* const found = dialog_->findChild<T*>(name);
    EXPECT_NE(found, nullptr) << name;
    return found;
  }
  QString make(bool good) {
    QSignalSpy made(&*dialog_, &NormDialog::made), refused(&*dialog_, &NormDialog::refused);
    part<QPushButton>("norm-make")->click();
    EXPECT_FALSE(part<QPushButton>("norm-make")->isEnabled()) << "one at a time";
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
  const QString text = make(true);
  ASSERT_EQ(norms().size(), 1U);
  const analytics::Norm norm = norms().front();
  EXPECT_EQ(norm.name, "clinic");
  EXPECT_EQ(norm.by, "me");
  EXPECT_EQ(norm.members.size(), 20U);
  EXPECT_EQ(norm.judgedBy, "performers skilled against unskilled");
  EXPECT_TRUE(norm.synthetic);
  ASSERT_EQ(norm.checkpoints.size(), 1U);
  EXPECT_TRUE(norm.checkpoints.front().inRule && norm.checkpoints.front().cut);
  EXPECT_TRUE(text.startsWith("SYNTHETIC"));
  EXPECT_TRUE(text.contains("Norm clinic version 1"));
  EXPECT_TRUE(text.contains("of 10 competent members pass")) << text.toStdString();
  EXPECT_TRUE(text.contains("FORMATIVE")) << "what it may be used for";
  EXPECT_TRUE(make(true).contains("version 2")) << "the same name again";
}

TEST_F(NormDialogs, OfThoseThatAreSelected) {
  open(uuids(12));
  EXPECT_EQ(part<QComboBox>("norm-attempts")->currentIndex(), 1);
  (void)make(true);
  EXPECT_EQ(norms().front().members.size(), 12U);
  part<QComboBox>("norm-attempts")->setCurrentIndex(0);
  (void)make(true);
  EXPECT_EQ(norms().back().members.size(), 20U);
}

TEST_F(NormDialogs, ARefusalStandsThereAndNothingIsStored) {
  open(uuids(4));
  expectHolds(make(false).toStdString(), {"3"});
  part<QComboBox>("norm-attempts")->setCurrentIndex(0);
  part<QLineEdit>("norm-name")->setText("two words");
  expectHolds(make(false).toStdString(), {"1", "64"});
  part<QLineEdit>("norm-name")->setText("clinic");
  part<QCheckBox>("norm-synthetic")->setChecked(false);
  expectHolds(make(false).toStdString(), {"norm"});
  EXPECT_TRUE(norms().empty());
  part<QLineEdit>("norm-by")->clear();
  EXPECT_FALSE(part<QPushButton>("norm-make")->isEnabled()) << "nobody makes it";
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

}  // namespace
}  // namespace calot::gui
