// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/page_html.h"

#include <fmt/format.h>

#include <vector>

#include "analytics/report/report_text.h"
#include "recorder/base/file_bytes.h"

namespace calot::analytics {
namespace {

// The policy forbids whatever is not in the page itself, should a text ever get through as markup.
constexpr const char* head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<meta name="viewport" content="width=device-width">
<style>
body { font: 15px/1.45 sans-serif; color: #1b1f24; max-width: 76em; margin: 2em auto; padding: 0 1em; }
h1 { font-size: 1.5em; } h2 { font-size: 1.15em; margin-top: 2em; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { padding: .2em .7em; border-bottom: 1px solid #d8dde3; text-align: left; white-space: nowrap; }
th { border-bottom: 2px solid #57606a; } .right { text-align: right; }
.figures { display: flex; flex-wrap: wrap; gap: 1em; } svg { max-width: 100%; height: auto; }
.watermark { background: #b00020; color: #fff; font-weight: bold; padding: .5em 1em; }
.behind { position: fixed; inset: 0; display: flex; align-items: center; justify-content: center; pointer-events: none;
  font: bold 14vw sans-serif; color: #b00020; opacity: .07; transform: rotate(-30deg); }
@media print { .page { break-before: page; } body { max-width: none; } figure, svg { break-inside: avoid; } }
)";

std::string cells(const std::vector<std::string>& row, const ReportTable& table, const char* tag) {
  std::string html = "<tr>";
  for (std::size_t c = 0; c < row.size(); ++c) {
    html +=
        fmt::format("<{}{}>{}</{}>", tag, table.columns[c].second == TextTable::Align::right ? " class=\"right\"" : "",
                    escaped(row[c]), tag);
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
