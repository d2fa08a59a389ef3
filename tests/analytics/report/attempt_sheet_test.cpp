// SPDX-License-Identifier: GPL-3.0-or-later
// The first page of a sheet: which moments it shows, its bars, its order, its clock.
#include "analytics/report/attempt_sheet.h"

#include <gtest/gtest.h>
#include <cstdlib>
#include <ctime>

#include "analytics/assessment/verdict.h"
#include "analytics/report/key_figures.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

AttemptRow attemptOf(const std::string& participant) {
  AttemptRow attempt;
  attempt.uuid = "01234567-89ab-cdef-0123-456789abcdef";
  attempt.participant = participant;
  attempt.scene = "cholecystectomy";
  attempt.startUtc = "2026-07-01T22:30:00Z";
  attempt.outcome = recorder::Outcome::completed;
  return attempt;
}

CheckpointValue valueOf(const char* name, const char* subject, double si, const std::string& note = "") {
  return makeValue(*findCheckpoint(name), subject, Origin::resimulated, si, note);
}

GradedFigure gradedAs(const char* name, const char* subject, Direction direction, double cut, bool passed) {
  GradedFigure figure;
  figure.mark.checkpoint = name;
  figure.mark.subject = subject;
  figure.mark.direction = direction;
  figure.mark.cut = cut;
  figure.passed = passed;
  return figure;
}

TEST(AttemptSheet, showsTheGravestMomentsThenFiguresByTime) {
  const std::vector<ErrorLine> errors{{Severity::critical, 1, 100.0, "cystic duct left open"},
                                      {Severity::major, 2, 40.0, "clip lost"},
                                      {Severity::minor, 9, 3.0, "bed torn"}};
  const std::vector<FigureMoments> figures{{"speed-mean", "left", {{5.0, 6.0, 0.9}}, ""},
                                           {"path-length", "left", {{40.2, 41.0, 0.5}, {70.0, 71.0, 0.7}}, ""},
                                           {"organ-burned", "liver", {{20.0, 21.0, 0.4}}, ""}};
  Grade grade;
  grade.figures = {gradedAs("organ-burned", "liver", Direction::lower, 0.0, false)};
  const std::vector<SheetMoment> graded = worstMoments(errors, figures, &grade);
  ASSERT_EQ(graded.size(), maxSheetMoments);
  EXPECT_EQ(graded[0].time, 20.5) << "falls short by the grade, before one that counts";
  EXPECT_EQ(graded[1].time, 40.0);
  EXPECT_EQ(graded[2].time, 100.0);
  expectHolds(graded[2].caption, {"1:40.0", "critical", "cystic duct left open"});
  const std::vector<SheetMoment> alone = worstMoments({errors[0]}, figures, nullptr);
  ASSERT_EQ(alone.size(), maxSheetMoments);
  EXPECT_EQ(alone[0].time, 20.5);
  EXPECT_EQ(alone[1].time, 70.5) << "its worst";
  EXPECT_EQ(worstMoments({{Severity::major, 1, 70.9, "clip lost"}}, {figures[1]}, nullptr).size(), 1U)
      << "two pictures of one moment say no more than one";
  EXPECT_TRUE(worstMoments({errors[2]}, {}, nullptr).empty()) << "minor errors are no moments";
}

TEST(AttemptSheet, barsAreAsLongAsTheirValuesBesideTheMark) {
  const std::vector<CheckpointValue> values{valueOf("elapsed-time", "", 200.0), valueOf("clip-errors", "", 2.0),
                                            valueOf("path-length", "left", 0.25)};
  Grade grade;
  grade.figures = {gradedAs("elapsed-time", "", Direction::lower, 100.0, false),
                   gradedAs("path-length", "left", Direction::lower, 0.5, true)};
  const std::vector<KeyFigure> figures = keyFigures(values, &grade);
  ASSERT_EQ(figures.size(), 3U);
  EXPECT_EQ(figures[0].number(), "2") << "a count is whole";
  EXPECT_EQ(figures[0].against(), "") << "the norm has no mark";
  expectHolds(figures[1].against(), {"100.0 s"});
  expectHolds(figures[2].against(), {"500.0 mm"});
  const Drawing drawing = drawKeyFigures(figures, 400.0, 1);
  std::vector<double> bars, marks;
  std::vector<Ink> inks;
  double left = 0.0;
  for (const Shape& shape : drawing.shapes) {
    if (const auto* box = std::get_if<DrawnBox>(&shape.form)) {
      left = box->x;
      bars.push_back(box->width);
      inks.push_back(shape.ink);
    }
    if (const auto* line = std::get_if<DrawnLine>(&shape.form); line != nullptr && shape.ink == Ink::cut)
      marks.push_back(line->x1);
  }
  ASSERT_EQ(bars.size(), 2U) << "no bar where there is no mark to hold it against";
  ASSERT_EQ(marks.size(), 2U);
  EXPECT_NEAR(bars[0], 2.0 * (marks[0] - left), 1e-9) << "twice the mark";
  EXPECT_NEAR(bars[1], 0.5 * (marks[1] - left), 1e-9);
  EXPECT_EQ(inks[0], Ink::secondBox) << "falls short";
  EXPECT_EQ(inks[1], Ink::firstBox);
  EXPECT_EQ(drawing.marks[2].key, "path-length left");
  EXPECT_LT(drawKeyFigures(figures, 400.0, 2).height, drawing.height);
}

TEST(AttemptSheet, oneWithoutANormSaysSoAndEndsWithEveryFigure) {
  AttemptSheet sheet{
      attemptOf("P<7>"),
      {valueOf("critical-errors", "", 1.0, "cystic duct left open, 1:40.0"), valueOf("major-errors", "", 0.0),
       valueOf("minor-errors", "", 9.0, "bed torn, 9 times, worst at 0:03.0"), valueOf("elapsed-time", "", 200.0)},
      nullptr,
      {{Severity::critical, 1, 100.0, "cystic duct left open"}},
      {},
      "the recording a.h5 was not found"};
  const ReportDocument document = sheetDocument(sheet);
  const std::string html = pageHtml(document);
  expectHolds(html, {"P&lt;7&gt;", errorSentence(Severity::critical, &sheet.values[0]), sheet.picturesMissing});
  std::size_t front = 0;
  while (!std::holds_alternative<Heading>(document.parts[front]) || !std::get<Heading>(document.parts[front]).newPage)
    ++front;
  for (std::size_t i = 0; i < front; ++i)
    EXPECT_FALSE(std::holds_alternative<ReportTable>(document.parts[i])) << "no table on the first page";
  EXPECT_TRUE(std::holds_alternative<ReportTable>(document.parts.back()));
  sheet.pictures = {{"\x89PNG", "1:40.0  critical: cystic duct left open"}};
  EXPECT_NE(pageHtml(sheetDocument(sheet)).find("src=\"data:image/png;base64,iVBORw"), std::string::npos);
}

TEST(AttemptSheet, timesAreThoseOfThisPlace) {
  const char* const before = std::getenv("TZ");
  const std::string kept = before != nullptr ? before : "";
  setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3", 1);
  tzset();
  EXPECT_EQ(localTime("2026-07-01T22:30:00Z"), "2026-07-02 00:30") << "in summer two hours on";
  EXPECT_EQ(localTime("2026-12-31T23:59:59Z"), "2027-01-01 00:59");
  EXPECT_EQ(localTime("some day"), "some day");
  if (before != nullptr)
    setenv("TZ", kept.c_str(), 1);
  else
    unsetenv("TZ");
  tzset();
}

}  // namespace
}  // namespace calot::analytics
