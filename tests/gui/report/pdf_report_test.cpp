// SPDX-License-Identifier: GPL-3.0-or-later
// A report on paper: pages, fonts, figures as vectors, watermark; without a display.
#include "gui/report/pdf_report.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <clocale>
#include <QBuffer>
#include <QByteArray>
#include <QGuiApplication>
#include <QImage>
#include <QPdfWriter>
#include <regex>
#include <string>

#include "analytics/report/attempt_sheet.h"
#include "analytics/report/plots.h"
#include "gui/report/text_document.h"

namespace calot::gui {
namespace {

using analytics::Drawing;
using analytics::Figures;
using analytics::Ink;
using analytics::ReportDocument;
using analytics::ReportTable;

std::size_t countOf(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  return static_cast<std::size_t>(
      std::distance(std::sregex_iterator(text.begin(), text.end(), expression), std::sregex_iterator()));
}

/// What the pages draw: every stream that zlib opens, one behind the other.
std::string drawn(const std::string& pdf) {
  std::string all;
  for (std::size_t at = 0; (at = pdf.find("stream\n", at)) != std::string::npos; ++at) {
    if (at >= 3 && pdf.compare(at - 3, 3, "end") == 0) continue;
    const std::size_t begin = at + 7, end = pdf.find("endstream", begin);
    if (end == std::string::npos) break;
    // qUncompress() wants the length of what comes out before it; a guess will do.
    QByteArray bytes("\0\1\0\0", 4);
    bytes += QByteArray(pdf.data() + begin, static_cast<qsizetype>(end - begin));
    all += qUncompress(bytes).toStdString() + "\n";
  }
  return all;
}

ReportDocument report(std::size_t rows, bool synthetic = false) {
  ReportDocument document{"A study <b>of</b> both", synthetic, {}};
  document.add("A paragraph & its words.");
  document.addList({"one", "two"});
  ReportTable table = analytics::tableOf("Values", {"=name", "n"});
  for (std::size_t i = 0; i < rows; ++i) table.rows.push_back({fmt::format("row {}", i), fmt::format("{}", i)});
  document.parts.emplace_back(table);
  return document;
}

std::size_t pagesOf(const std::string& pdf) { return countOf(pdf, "/Type /Page\\b(?!s)"); }

TEST(PdfReport, isPagesOfA4WithItsFontEmbedded) {
  const std::string pdf = pdfReport(report(10), "calot test");
  EXPECT_EQ(pdf.compare(0, 5, "%PDF-"), 0);
  EXPECT_NE(pdf.find("%%EOF", pdf.size() - 8), std::string::npos);
  EXPECT_EQ(pagesOf(pdf), 1U);
  EXPECT_NE(pdf.find("/FontFile2"), std::string::npos);
  std::smatch box;
  ASSERT_TRUE(std::regex_search(pdf, box, std::regex("/MediaBox \\[0 0 ([0-9.]+) ([0-9.]+) ?\\]")));
  EXPECT_NEAR(std::stod(box[1]), 210.0 / 25.4 * 72.0, 0.5);
  EXPECT_NEAR(std::stod(box[2]), 297.0 / 25.4 * 72.0, 0.5);
}

TEST(PdfReport, longTablesGoOverAsManyPagesAsTheyNeed) {
  const std::string pdf = pdfReport(report(400), "calot test");
  EXPECT_GE(pagesOf(pdf), 5U);
  EXPECT_LE(pagesOf(pdf), 12U);
}

/// A sheet's first page with as much on it as there can be.
ReportDocument fullFront() {
  std::string errors;
  for (int i = 0; i < 30; ++i)
    errors += fmt::format("{}cystic duct left open towards the specimen, 1:{}.0", i > 0 ? "; " : "", 10 + i);
  const auto of = [](const char* name, const char* subject, double si, const std::string& note = "") {
    return analytics::makeValue(*analytics::findCheckpoint(name), subject, analytics::Origin::resimulated, si, note);
  };
  QImage image(640, 480, QImage::Format_RGB32);
  image.fill(Qt::darkRed);
  QBuffer png;
  image.save(&png, "PNG");
  analytics::AttemptSheet sheet;
  sheet.attempt.scene = "cholecystectomy";
  sheet.attempt.synthetic = true;
  sheet.values = {of("critical-errors", "", 30.0, errors),
                  of("major-errors", "", 30.0, errors),
                  of("minor-errors", "", 9.0),
                  of("critical-view", "", 3.0),
                  of("clip-errors", "", 2.0),
                  of("organ-burned", "liver", 0.1),
                  of("organ-burned", "gallbladder", 0.1),
                  of("organ-perforations", "liver", 1),
                  of("elapsed-time", "", 200.0),
                  of("path-length", "left", 1.0),
                  of("path-length", "right", 4.0)};
  for (int i = 0; i < 3; ++i)
    sheet.pictures.push_back(
        {png.data().toStdString(), "1:40.2  critical: cystic duct burned through instead of cut, 18 times"});
  ReportDocument document = analytics::sheetDocument(sheet);
  const auto appendix = std::find_if(document.parts.begin(), document.parts.end(), [](const auto& part) {
    const auto* heading = std::get_if<analytics::Heading>(&part);
    return heading != nullptr && heading->newPage;
  });
  document.parts.erase(appendix, document.parts.end());
  return document;
}

TEST(PdfReport, theFirstPageOfASheetIsOnePageWithItsPictures) {
  const std::string pdf = pdfReport(fullFront(), "calot test");
  EXPECT_EQ(pagesOf(pdf), 1U);
  EXPECT_GE(countOf(pdf, "/Subtype /Image"), 1U);
}

TEST(PdfReport, figuresAreVectors) {
  const std::vector<double> a{1, 2, 3, 4, 5, 6, 7}, b{2, 4};
  ReportDocument without = report(3), with = report(3);
  Figures figures;
  for (int i = 0; i < 3; ++i)
    figures.drawings.push_back(*analytics::drawBoxPlot(
        {.title = fmt::format("figure {}", i), .axis = "mm", .groups = {"x", "y"}, .values = {a, b}}));
  with.parts.emplace_back(figures);
  const std::string plain = drawn(pdfReport(without, "t")), pdf = pdfReport(with, "t"), full = drawn(pdf);
  EXPECT_EQ(pdf.find("/Subtype /Image"), std::string::npos);
  // A point is a circle of four curves; letters are of the font, no curves of the page.
  const auto curves = [&](const std::string& text) { return countOf(text, "[0-9.]+ c\n"); };
  EXPECT_EQ(curves(full) - curves(plain), 3U * (a.size() + b.size()) * 4U);
}

TEST(PdfReport, everyPageOfASyntheticReportHasTheMark) {
  // The same pages, but for the mark of each and the banner at both ends.
  const std::string plain = pdfReport(report(60), "t"), marked = pdfReport(report(60, true), "t");
  EXPECT_EQ(pagesOf(plain), pagesOf(marked));
  const std::string one = drawn(marked);
  // The mark is the only thing that is turned: a matrix with sines off its diagonal.
  EXPECT_EQ(countOf(one, "-?0\\.[0-9]{2,} -?0\\.[0-9]{2,} -?0\\.[0-9]{2,} -?0\\.[0-9]{2,} -?[0-9.]+ -?[0-9.]+ cm"),
            pagesOf(marked));
  EXPECT_EQ(
      countOf(drawn(plain), "-?0\\.[0-9]{2,} -?0\\.[0-9]{2,} -?0\\.[0-9]{2,} -?0\\.[0-9]{2,} -?[0-9.]+ -?[0-9.]+ cm"),
      0U);
}

TEST(PdfReport, hasEveryWordOfTheDocument) {
  int count = 3;
  char name[] = "test", option[] = "-platform", platform[] = "offscreen";
  char* words[] = {name, option, platform, nullptr};
  const QGuiApplication application(count, words);
  QBuffer buffer;
  buffer.open(QIODevice::WriteOnly);
  QPdfWriter writer(&buffer);
  const ReportDocument document = report(2, true);
  const ReportTextDocument text(document, &writer, QSizeF(4000, 6000));
  const std::string plain = text.toPlainText().toStdString();
  for (const char* expected : {"A study <b>of</b> both", "A paragraph & its words.", "one", "two", "Values", "name",
                               "row 0", "row 1", "SYNTHETIC: made by performers"})
    EXPECT_NE(plain.find(expected), std::string::npos) << expected;
  // Within an application that is there already it is made, too, and leaves it.
  EXPECT_EQ(pdfReport(document, "t").compare(0, 5, "%PDF-"), 0);
  EXPECT_NE(QGuiApplication::instance(), nullptr);
}

TEST(PdfReport, leavesTheLocaleAsItWas) {
  const std::string before = std::setlocale(LC_ALL, nullptr);
  ::setenv("LC_ALL", "C.UTF-8", 1);
  (void)pdfReport(report(1), "t");
  ::unsetenv("LC_ALL");
  EXPECT_EQ(before, std::setlocale(LC_ALL, nullptr));
}

}  // namespace
}  // namespace calot::gui
