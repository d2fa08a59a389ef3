// SPDX-License-Identifier: GPL-3.0-or-later
// What the page and the terminal are made of: escaping, box plots, tables that fit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <regex>
#include <sstream>

#include "analytics/report/plots.h"
#include "analytics/report/report_document.h"

namespace calot::analytics {
namespace {

std::vector<double> attributes(const std::string& svg, const std::string& pattern) {
  std::vector<double> found;
  const std::regex expression(pattern);
  for (std::sregex_iterator at(svg.begin(), svg.end(), expression), end; at != end; ++at)
    found.push_back(std::stod((*at)[1].str()));
  return found;
}

TEST(Html, escapesWhatWouldBeMarkup) {
  EXPECT_EQ(escaped("<script>\"a\" & 'b'</script>"), "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/script&gt;");
  EXPECT_EQ(escaped("\u00e9\u2264\U0001F600"), "\u00e9\u2264\U0001F600");
  const std::string bad = "\xEF\xBF\xBD";
  EXPECT_EQ(escaped(std::string("a\0b\x1B", 4)), "a" + bad + "b" + bad);
  EXPECT_EQ(escaped("\xC3<"), bad + "&lt;") << "half a letter does not swallow what follows";
  EXPECT_EQ(escaped("\xC0\xBC"), bad + bad) << "an overlong '<'";
  EXPECT_EQ(escaped("\xED\xA0\x80"), bad + bad + bad) << "half a surrogate pair";
}

TEST(BoxPlot, hasTheQuartilesTheWhiskersAndEveryPoint) {
  // 1..9 and an outlier: type 7 quartiles 3.25, 5.5, 7.75; the whisker ends at 9, not at 30.
  const std::vector<double> a{1, 2, 3, 4, 5, 6, 7, 8, 9, 30}, b{4, 4};
  const std::string svg = svgOf(*drawBoxPlot({.title = "a <b>", .axis = "mm", .groups = {"x", "y"}, .values = {a, b}}));
  EXPECT_NE(svg.find("a &lt;b&gt;"), std::string::npos);
  EXPECT_EQ(svg.find("<b>"), std::string::npos);
  EXPECT_EQ(svg.find("SYNTHETIC"), std::string::npos);
  const std::vector<double> y = attributes(svg, R"re(<circle class="point [a-z]+" cx="[^"]*" cy="([^"]*)")re");
  ASSERT_EQ(y.size(), 12U);
  // The scale is linear: from the points 1 and 30 every other follows. Two decimals are printed.
  const double perUnit = (y[9] - y[0]) / 29.0;
  EXPECT_LT(perUnit, 0.0) << "upwards is more";
  const auto expected = [&](double value) { return y[0] + (value - 1.0) * perUnit; };
  EXPECT_NEAR(y[4], expected(5.0), 0.02);
  EXPECT_NEAR(y[10], expected(4.0), 0.02);
  const auto boxes = attributes(svg, R"re(<rect class="box [a-z]+" x="[^"]*" y="([^"]*)")re");
  const auto heights = attributes(svg, R"re(<rect class="box [a-z]+" [^>]*height="([^"]*)")re");
  ASSERT_EQ(boxes.size(), 1U) << "of two values the points alone";
  EXPECT_NEAR(boxes[0], expected(7.75), 0.02);
  EXPECT_NEAR(heights[0], -4.5 * perUnit, 0.02);
  EXPECT_NEAR(attributes(svg, R"re(<line class="median" [^>]*y1="([^"]*)")re")[0], expected(5.5), 0.02);
  const auto whiskers = attributes(svg, R"re(<line class="whisker" [^>]*y2="([^"]*)")re");
  ASSERT_EQ(whiskers.size(), 4U);
  EXPECT_NEAR(whiskers[1], expected(9.0), 0.02);
}

TEST(BoxPlot, drawsOneInSoManyOfThousandsWithBothExtremesAndSaysSo) {
  std::vector<double> many(4825), few(200);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = static_cast<double>(i * 7 % many.size());
  for (std::size_t i = 0; i < few.size(); ++i) few[i] = static_cast<double>(20 * i);
  const std::string svg = svgOf(*drawBoxPlot({.title = "t", .axis = "", .groups = {"x", "y"}, .values = {many, few}}));
  EXPECT_NE(svg.find(">n = 4825, one in 25 drawn<"), std::string::npos);
  EXPECT_NE(svg.find(">n = 200<"), std::string::npos);
  const std::vector<double> y = attributes(svg, R"re(<circle class="point first" cx="[^"]*" cy="([^"]*)")re");
  const std::vector<double> of = attributes(svg, R"re(<circle class="point second" cx="[^"]*" cy="([^"]*)")re");
  ASSERT_EQ(of.size(), 200U);
  ASSERT_EQ(y.size(), 194U);
  const double perUnit = (of[199] - of[0]) / 3980.0;
  EXPECT_NEAR(y.front(), of[0], 0.02);
  EXPECT_NEAR(y.back(), of[0] + 4824.0 * perUnit, 0.02);
}

TEST(BoxPlot, staysInsideItsFrameForAnyValues) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  for (const double scale : {1e-290, 1e-9, 1.0, 1e12, 1e290}) {
    for (const double centre : {0.0, 5.0}) {
      std::vector<double> values(1 + random() % 30);
      for (double& v : values) v = (normal(random) + centre) * scale;
      const auto plot =
          drawBoxPlot({.title = "t", .axis = "", .groups = {"x", "y"}, .values = {values, {}}, .synthetic = true});
      ASSERT_TRUE(plot);
      const std::string svg = svgOf(*plot);
      EXPECT_NE(svg.find(">SYNTHETIC<"), std::string::npos);
      EXPECT_EQ(svg.find("nan"), std::string::npos);
      EXPECT_EQ(svg.find("inf"), std::string::npos);
      for (const double y : attributes(svg, R"re(c?y[12]?="([^"]*)")re")) {
        EXPECT_GE(y, 0.0);
        EXPECT_LE(y, 240.0);
      }
    }
  }
  const std::vector<double> none, huge{-1.7e308, 1.7e308}, same{3, 3, 3}, zero{0, 0};
  EXPECT_FALSE(drawBoxPlot({.title = "", .axis = "", .groups = {}, .values = {none, none}}));
  EXPECT_FALSE(drawBoxPlot({.title = "", .axis = "", .groups = {}, .values = {huge, none}}));
  EXPECT_TRUE(drawBoxPlot({.title = "", .axis = "", .groups = {}, .values = {same, zero}}));
  EXPECT_TRUE(drawBoxPlot({.title = "", .axis = "", .groups = {}, .values = {same, same}}));
  EXPECT_TRUE(drawBoxPlot({.title = "", .axis = "", .groups = {}, .values = {zero, none}}));
}

TEST(ForestPlot, hasEveryEffectOnOneAxis) {
  const Drawing drawing = drawForest({.title = "A <b>",
                                      .below = "against",
                                      .above = "for",
                                      .rows = {{"one", 0.5, 0.25, 0.75}, {"two", 1.0, 0.5, 1.0}}});
  const std::string svg = svgOf(drawing);
  const std::vector<double> x = attributes(svg, R"re(<circle class="point first" cx="([^"]*)")re");
  ASSERT_EQ(x.size(), 2U);
  const auto from = attributes(svg, R"re(<line class="median" x1="([^"]*)")re");
  const auto to = attributes(svg, R"re(<line class="median" [^>]*x2="([^"]*)")re");
  const double unit = 2.0 * (x[1] - x[0]);  // from 0 to 1
  EXPECT_NEAR(from[0], x[0] - 0.25 * unit, 0.02);
  EXPECT_NEAR(to[0], x[0] + 0.25 * unit, 0.02);
  EXPECT_NEAR(from[1], x[0], 0.02);
  EXPECT_NEAR(to[1], x[1], 0.02);
  const auto half = attributes(svg, R"re(<line class="cut" x1="([^"]*)")re");
  ASSERT_EQ(half.size(), 1U);
  EXPECT_NEAR(half[0], x[0], 0.02);
  EXPECT_NE(svg.find("0.50 [0.25, 0.75]"), std::string::npos);
  EXPECT_EQ(svg.find("<b>"), std::string::npos);
}

TEST(Drawing, everyInkHasItsRuleInThePage) {
  const std::string css = drawingCss();
  for (std::uint8_t i = 0; i <= static_cast<std::uint8_t>(Ink::watermark); ++i) {
    std::string selector = std::string(".") + styleOf(static_cast<Ink>(i)).name;
    std::replace(selector.begin(), selector.end(), ' ', '.');
    EXPECT_NE(css.find(selector + " {"), std::string::npos) << selector;
  }
  EXPECT_NE(css.find("stroke-dasharray"), std::string::npos) << "a pass mark is dashed";
}

TEST(Page, showsEveryPartEscaped) {
  ReportDocument document{"a <title>", false, {}};
  document.add("a & b");
  document.addList({"<i>"});
  document.parts.emplace_back(Paragraph{{"see ", {}}, {"there", "x\"y.h5#t=1,2"}});
  document.parts.emplace_back(ReportTable{"T", {{"n", Align::right}}, {{"<1>"}}});
  const std::string page = pageHtml(document);
  EXPECT_NE(page.find("<h1>a &lt;title&gt;</h1>"), std::string::npos);
  EXPECT_NE(page.find("<p>a &amp; b</p>"), std::string::npos);
  EXPECT_NE(page.find("<li>&lt;i&gt;</li>"), std::string::npos);
  EXPECT_NE(page.find("see <a href=\"x&quot;y.h5#t=1,2\">there</a>"), std::string::npos);
  EXPECT_NE(page.find("<td class=\"right\">&lt;1&gt;</td>"), std::string::npos);
  EXPECT_EQ(page.find("SYNTHETIC"), std::string::npos);
  document.synthetic = true;
  const std::string marked = pageHtml(document);
  std::size_t marks = 0;
  for (std::size_t at = 0; (at = marked.find(watermarkText, at)) != std::string::npos; ++at) ++marks;
  EXPECT_EQ(marks, 2U) << "at its beginning and at its end";
}

TEST(BoxPlot, ticksAreRoundAndWithin) {
  EXPECT_EQ(roundTicks(0.0, 10.0), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(roundTicks(-1.2, 1.3), (std::vector<double>{-1.0, -0.5, 0.0, 0.5, 1.0}));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> exponent(-12.0, 12.0), part(0.0, 1.0);
  for (int i = 0; i < 2000; ++i) {
    const double low = (part(random) - 0.5) * std::pow(10.0, exponent(random));
    const double high = low + std::max(std::abs(low) * 1e-6, std::pow(10.0, exponent(random)));
    const std::vector<double> ticks = roundTicks(low, high);
    EXPECT_GE(ticks.size(), 3U) << low << ' ' << high;
    EXPECT_LE(ticks.size(), 10U) << low << ' ' << high;
    EXPECT_GE(ticks.front(), low - (high - low) * 1e-9);
    EXPECT_LE(ticks.back(), high + (high - low) * 1e-9);
  }
}

TEST(TextTable, isCutWhereItMustFit) {
  ReportTable table = tableOf("", {"=name", "=other", "v"});
  table.rows.push_back({"a-very-long-name-of-something-\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9", "short", "1.5"});
  table.rows.push_back({"b", "a text that is longer than ten", "20"});
  std::ostringstream wide, narrow;
  table.print(wide);
  table.print(narrow, 40);
  EXPECT_NE(wide.str().find("something-\u00e9\u00e9\u00e9\u00e9\u00e9\u00e9"), std::string::npos);
  std::istringstream lines(narrow.str());
  for (std::string line; std::getline(lines, line);) {
    const auto letters = std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
    EXPECT_LE(letters, 40) << line;
  }
  EXPECT_NE(narrow.str().find("..."), std::string::npos);
  EXPECT_NE(narrow.str().find("1.5"), std::string::npos) << "numbers are never cut";
}

TEST(TextTable, goesOnInTheNextLineBeforeItCuts) {
  ReportTable table = tableOf("", {"=name", "v"});
  table.rows.push_back({"movement-straightness left", "1"});
  table.rows.push_back({"movement-straightness right", "2"});
  table.rows.push_back({"  of an-unbroken-word-of-many-letters", "3"});
  std::ostringstream out;
  table.print(out, 24);
  EXPECT_EQ(out.str(),
            "name                   v\n"
            "---------------------  -\n"
            "movement-straightness  1\n"
            "  left\n"
            "movement-straightness  2\n"
            "  right\n"
            "  of                   3\n"
            "  an-unbroken-word...\n");
  ReportTable pairs = tableOf("", {"=name", "v"});
  pairs.rows.push_back({"movement-straightness left", "1"});
  pairs.rows.push_back({"", "2"});
  std::ostringstream below;
  pairs.print(below, 24);
  EXPECT_EQ(below.str(),
            "name                   v\n"
            "---------------------  -\n"
            "movement-straightness  1\n"
            "  left                 2\n")
      << "in the next row's empty cell";
  ReportTable figures = tableOf("", {"=name", "=origin", "="});
  figures.rows.push_back({"fat-remaining-inside", "samples", "gallbladder that was not freed"});
  std::ostringstream whole;
  figures.print(whole, 48);
  EXPECT_EQ(whole.str(),
            "name                  origin\n"
            "--------------------  -------  -----------------\n"
            "fat-remaining-inside  samples  gallbladder that\n"
            "                                 was not freed\n")
      << "a remark is broken before a name is cut";
  ReportTable reasons = tableOf("", {"=name", "=reason"});
  reasons.rows.push_back({"first", "some long text"});
  reasons.rows.push_back({"second", ""});
  std::ostringstream own;
  reasons.print(own, 18);
  EXPECT_EQ(own.str(),
            "name    reason\n"
            "------  ----------\n"
            "first   some long\n"
            "          text\n"
            "second\n")
      << "never in another's row";
}

}  // namespace
}  // namespace calot::analytics
