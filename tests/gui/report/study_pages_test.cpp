// SPDX-License-Identifier: GPL-3.0-or-later
// A study as printed: two pages, then the appendix; what belongs together is on one page.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <QBuffer>
#include <QGuiApplication>
#include <QPdfWriter>
#include <QTextTable>
#include <string>
#include <vector>

#include "analytics/report/study_output.h"
#include "gui/report/text_document.h"
#include "tests/analytics/cohort/support/cohort_support.h"

namespace calot::gui {
namespace {

using analytics::CohortDatabase;
using analytics::Study;
using analytics::StudyDetail;

/// How much a study has to print.
struct Size {
  unsigned people = 20;
  std::size_t letters = 8;   ///< of the names of groups, sites and people
  std::size_t figures = 12;  ///< of the registry
  bool declared = false;     ///< all of them lead
};

std::string longName(const std::string& name, std::size_t letters) {
  return name.size() >= letters ? name : name + std::string(letters - name.size(), 'x');
}

/// Two groups of a cohort, some of whose attempts are left out for as many reasons as there are.
Study studyOf(const Size& size) {
  const analytics::support::Folder folder;
  CohortDatabase database(folder.file(longName("cohort", size.letters) + ".db"), CohortDatabase::Access::create);
  const std::string groups[] = {longName("expert", size.letters), longName("novice", size.letters)};
  analytics::StudyOptions options;
  options.attemptRule = analytics::AttemptRule::first;
  options.better = groups[0];
  for (unsigned n = 0; n < size.people; ++n) {
    const std::string who = longName(fmt::format("P{:03}", n), size.letters);
    database.addParticipant({who,
                             groups[n % 2],
                             longName(fmt::format("arm{}", n % 3), size.letters),
                             longName(fmt::format("site{}", n % 5), size.letters),
                             {{"laparoscopies", std::to_string(10 * n)}, {"handedness", n % 4 == 0 ? "left" : "right"}},
                             {}});
    analytics::AttemptRecord attempt = analytics::support::humanAttempt(n, who);
    if (n % 10 == 9) attempt.mode = recorder::Mode::practice;
    if (n % 10 == 8) attempt.verification.verdict = analytics::Verdict::diverged;
    if (n % 10 == 7) attempt.complete = false;
    std::vector<analytics::CheckpointValue> values;
    for (const auto& entry : analytics::checkpointRegistry()) {
      if (values.size() == size.figures) break;
      if (entry.definition.direction == analytics::Direction::none) continue;
      values.push_back(analytics::makeValue(entry.definition, "", entry.definition.origins.front(),
                                            1.0 + static_cast<double>((n * 7 + values.size()) % 11 + n % 2)));
      if (size.declared) options.family.push_back(entry.definition.name);
    }
    database.storeAttempt(attempt, values);
  }
  std::sort(options.family.begin(), options.family.end());
  options.family.erase(std::unique(options.family.begin(), options.family.end()), options.family.end());
  return analytics::makeStudy(database, options);
}

class StudyPages : public testing::TestWithParam<Size> {
 protected:
  void SetUp() override {
    buffer_.open(QIODevice::WriteOnly);
    writer_.setResolution(600);
    writer_.setPageSize(QPageSize(QPageSize::A4));
    writer_.setPageMargins(QMarginsF(15, 15, 15, 15), QPageLayout::Millimeter);
  }
  [[nodiscard]] QSizeF page() const { return textPageOf(writer_); }

 private:
  int count_ = 3;
  char name_[5] = "test", option_[10] = "-platform", platform_[10] = "offscreen";
  char* words_[4] = {name_, option_, platform_, nullptr};
  QGuiApplication application_{count_, words_};
  QBuffer buffer_;

 protected:
  QPdfWriter writer_{&buffer_};
};

TEST_P(StudyPages, areTwoBeforeTheAppendix) {
  const Study study = studyOf(GetParam());
  const auto all = analytics::studyDocument(study), two = analytics::studyDocument(study, StudyDetail::first);
  EXPECT_EQ(ReportTextDocument(two, &writer_, page()).pageCount(), 2);
  const ReportTextDocument text(all, &writer_, page());
  QStringList firstOfPages;
  for (QTextBlock block = text.begin(); block.isValid(); block = block.next()) {
    if (!ReportTextDocument::isHeading(block)) continue;
    const int at = text.pageOf(text.extentOf(block).top);
    while (firstOfPages.size() <= at) firstOfPages += QString();
    if (firstOfPages[at].isEmpty()) firstOfPages[at] = block.text();
  }
  ASSERT_GT(firstOfPages.size(), 2);
  EXPECT_EQ(firstOfPages[2], "Appendix");
  EXPECT_EQ(firstOfPages.count("Appendix"), 1);
}

TEST_P(StudyPages, haveNoHeadingAloneAndNoRowBelowTheirEnd) {
  const auto document = analytics::studyDocument(studyOf(GetParam()));
  const ReportTextDocument text(document, &writer_, page());
  int headings = 0, rows = 0;
  for (QTextBlock block = text.begin(); block.isValid(); block = block.next()) {
    const ReportTextDocument::Extent own = text.extentOf(block, 1);
    EXPECT_EQ(text.pageOf(own.top), text.pageOf(own.bottom - 1.0)) << block.text().toStdString();
    if (!ReportTextDocument::isHeading(block) || !block.next().isValid()) continue;
    ++headings;
    EXPECT_EQ(text.pageOf(own.top), text.pageOf(text.extentOf(block.next(), 2).bottom - 1.0))
        << block.text().toStdString();
    const QTextTable* const table = QTextCursor(block.next()).currentTable();
    if (table == nullptr) continue;
    for (int r = 0; r < table->rows(); ++r, ++rows) {
      const auto [top, bottom] = text.extentOf(*table, r);
      EXPECT_EQ(text.pageOf(top), text.pageOf(bottom - 1.0)) << block.text().toStdString() << ", row " << r;
      if (r != 1) continue;
      EXPECT_EQ(text.pageOf(own.top), text.pageOf(bottom - 1.0)) << block.text().toStdString();
    }
  }
  EXPECT_GT(headings, 5);
  EXPECT_GT(rows, 20);
}

INSTANTIATE_TEST_SUITE_P(Sizes, StudyPages,
                         testing::Values(Size{}, Size{6, 8, 3, false}, Size{20, 8, 40, true}, Size{100, 60, 40, true}));

}  // namespace
}  // namespace calot::gui
