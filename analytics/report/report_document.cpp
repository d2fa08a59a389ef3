// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/report_document.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <vector>

#include "recorder/base/files.h"

namespace calot::analytics {
namespace {

unsigned byteAt(std::string_view text, std::size_t i) { return static_cast<unsigned char>(text[i]); }

/// Length of the well-formed sequence of UTF-8 that begins at `i` (Unicode 15, table 3-7), or 0.
std::size_t sequenceAt(std::string_view text, std::size_t i) {
  const unsigned first = byteAt(text, i);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xC2 && first <= 0xDF   ? 2
                             : first >= 0xE0 && first <= 0xEF ? 3
                             : first >= 0xF0 && first <= 0xF4 ? 4
                                                              : 0;
  if (length == 0 || i + length > text.size()) return 0;
  for (std::size_t k = 1; k < length; ++k) {
    if ((byteAt(text, i + k) & 0xC0U) != 0x80U) return 0;
  }
  const unsigned second = byteAt(text, i + 1);
  const bool overlong = (first == 0xE0 && second < 0xA0) || (first == 0xF0 && second < 0x90);
  const bool outside = (first == 0xED && second > 0x9F) || (first == 0xF4 && second > 0x8F);  // surrogates; the end
  return overlong || outside ? 0 : length;
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = sequenceAt(text, i);
    const unsigned c = byteAt(text, i);
    if (length == 0 || (c < 0x20 && c != '\n' && c != '\t') || c == 0x7F) {
      out += "\xEF\xBF\xBD";
      ++i;
      continue;
    }
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else if (c == '\'') {
      out += "&#39;";
    } else {
      out += text.substr(i, length);
    }
    i += length;
  }
  return out;
}

std::string coverageWarning(CoveredInterval interval, const std::string& name, std::size_t nx, std::size_t ny,
                            const std::string& unit) {
  CoverageDoubt doubt;
  if (!doubtful(interval, nx, ny, doubt)) return {};
  if (!doubt.known) return fmt::format("{}: coverage is not known for fewer than {} {}", name, doubt.size, unit);
  return fmt::format("{}: with {} {} an interval at 95 % covers {} % (population: {})", name, doubt.size, unit,
                     doubt.percent, doubt.population);
}

ReportTable tableOf(const std::string& title, const std::vector<std::string>& columns) {
  ReportTable table;
  table.title = title;
  for (const std::string& column : columns) {
    const bool left = column.rfind('=', 0) == 0;
    table.columns.emplace_back(column.substr(left ? 1 : 0), left ? Align::left : Align::right);
  }
  return table;
}

void dropEmptyColumns(ReportTable& table) {
  for (std::size_t c = table.columns.size(); c-- > 0;) {
    const auto column = static_cast<std::ptrdiff_t>(c);
    if (std::any_of(table.rows.begin(), table.rows.end(), [&](const auto& row) { return !row[c].empty(); })) continue;
    table.columns.erase(table.columns.begin() + column);
    for (auto& row : table.rows) row.erase(row.begin() + column);
  }
}

std::size_t columnsOf(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

std::string cutTo(const std::string& text, std::size_t width) {
  if (columnsOf(text) <= width) return text;
  std::size_t end = 0;
  for (std::size_t seen = 0; end < text.size(); ++end) {
    if ((static_cast<unsigned char>(text[end]) & 0xC0U) != 0x80U && seen++ == width - 3) break;
  }
  return text.substr(0, end) + "...";
}

std::string significant(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  const double size = std::abs(value);
  if (size < arithmeticDust) return "0";
  if (size < 1e-4 || size >= 1e7) return fmt::format("{:.{}e}", value, digits - 1);
  const int magnitude = static_cast<int>(std::floor(std::log10(size)));
  return fmt::format("{:.{}f}", value, std::clamp(digits - 1 - magnitude, 0, 8));
}

std::string pText(double p) { return p < 0.0001 ? "<0.0001" : fmt::format("{:.4f}", p); }

std::string significantOrDash(const std::optional<double>& value, int digits) {
  return value ? significant(*value, digits) : "-";
}

namespace {

// The policy forbids whatever is not in the page itself, should a text ever get through as markup.
constexpr const char* head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'; img-src data:">
<meta name="viewport" content="width=device-width">
<style>
body { font: 15px/1.45 sans-serif; color: #1b1f24; max-width: 76em; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.5em; } h2 { font-size: 1.15em; margin-top: 2em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2em .7em; border-bottom: 1px solid #d8dde3; text-align: left; white-space: nowrap; }
th { border-bottom: 2px solid #57606a; } .right { text-align: right; }
.words { white-space: normal; min-width: 16em; vertical-align: top; }
.figures { display: flex; flex-wrap: wrap; gap: 1em; } svg, img { max-width: 100%; height: auto; }
.pictures { display: grid; grid-template-columns: repeat(3, 1fr); gap: 1em; } figure { margin: 0; }
.blank { border: 1px solid #57606a; padding: .2em .5em; margin: .5em 0; color: #57606a; }
.watermark { background: #b00020; color: #fff; font-weight: bold; padding: .5em 1em; }
.behind { position: fixed; inset: 0; display: flex; align-items: center; justify-content: center; pointer-events: none;
  font: bold 14vw sans-serif; color: #b00020; opacity: .07; transform: rotate(-30deg); }
@media print { .page { break-before: page; } h2 { break-after: avoid; } body { max-width: none; }
  figure, svg, tr { break-inside: avoid; } thead { display: table-header-group; } }
)";

std::string cells(const std::vector<std::string>& row, const ReportTable& table, const char* tag) {
  std::string html = "<tr>";
  constexpr std::size_t longest = 60;  // letters of a cell on one line
  for (std::size_t c = 0; c < row.size(); ++c) {
    const char* kind = row[c].size() > longest                   ? " class=\"words\""
                       : table.columns[c].second == Align::right ? " class=\"right\""
                                                                 : "";
    html += fmt::format("<{}{}>{}</{}>", tag, kind, escaped(row[c]), tag);
  }
  return html + "</tr>\n";
}

std::string spans(const Paragraph& paragraph) {
  std::string html;
  for (const TextSpan& span : paragraph) {
    html += span.link.empty() ? escaped(span.text)
                              : fmt::format("<a href=\"{}\">{}</a>", escaped(span.link), escaped(span.text));
  }
  return html;
}

struct Part {
  std::string operator()(const Heading& heading) const {
    return fmt::format("<h2{}>{}</h2>\n", heading.newPage ? " class=\"page\"" : "", escaped(heading.text));
  }
  std::string operator()(const Paragraph& paragraph) const { return fmt::format("<p>{}</p>\n", spans(paragraph)); }
  std::string operator()(const BulletList& list) const {
    std::string html = "<ul>\n";
    for (const Paragraph& item : list.items) html += fmt::format("<li>{}</li>\n", spans(item));
    return html + "</ul>\n";
  }
  std::string operator()(const ReportTable& table) const {
    std::vector<std::string> names;
    for (const auto& column : table.columns) names.push_back(column.first);
    std::string html = fmt::format("<h2>{}</h2>\n<div class=\"wide\"><table>\n<thead>", escaped(table.title));
    html += cells(names, table, "th") + "</thead>\n<tbody>\n";
    for (const auto& row : table.rows) html += cells(row, table, "td");
    return html + "</tbody>\n</table></div>\n";
  }
  std::string operator()(const Figures& figures) const {
    std::string html = "<div class=\"figures\">\n";
    for (const Drawing& drawing : figures.drawings) html += svgOf(drawing);
    return html + "</div>\n";
  }
  std::string operator()(const Pictures& pictures) const {
    std::string html = "<div class=\"pictures\">\n";
    for (const Picture& picture : pictures.pictures)
      html += fmt::format(
          "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
          escaped(picture.caption), recorder::base64(std::as_bytes(std::span(picture.png))));
    return html + "</div>\n";
  }
  std::string operator()(const Blank& blank) const {
    return fmt::format("<div class=\"blank\" style=\"min-height: {:.0f}mm\">{}</div>\n", blank.millimetres,
                       escaped(blank.label));
  }
};

}  // namespace

std::string pageHtml(const ReportDocument& document, const CarriedRecording* recording) {
  const std::string title = escaped(document.title);
  const std::string mark =
      document.synthetic ? fmt::format("<p class=\"watermark\">{}</p>\n", escaped(watermarkText)) : std::string();
  std::string html = head + drawingCss() + "</style>\n";
  html += fmt::format("<title>{}{}</title>\n</head>\n<body>\n", document.synthetic ? "SYNTHETIC: " : "", title);
  if (document.synthetic) html += "<div class=\"behind\" aria-hidden=\"true\">SYNTHETIC</div>\n";
  html += mark + fmt::format("<h1>{}</h1>\n", title);
  for (const auto& part : document.parts) html += std::visit(Part{}, part);
  html += mark;
  if (recording != nullptr) {
    html += fmt::format(
        "<p>This page carries the recording {0}. Drop it on calot-page.html to see the attempt and its proof.</p>\n"
        "<script type=\"application/x-calot-recording\" id=\"recording\" data-name=\"{0}\">\n{1}\n</script>\n",
        escaped(recording->name), recorder::base64(recording->bytes));
  }
  return html + "</body>\n</html>\n";
}

}  // namespace calot::analytics
