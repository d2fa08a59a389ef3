// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/page_html.h"

#include <fmt/format.h>

#include "analytics/report/html_text.h"

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
.heading { font: bold 12px sans-serif; } .tick { font: 10px sans-serif; text-anchor: end; }
.axis, .group { font: 11px sans-serif; text-anchor: middle; }
.grid { stroke: #e3e7eb; } .whisker { stroke: #57606a; } .median { stroke: #1b1f24; stroke-width: 2.5; }
.cut { stroke: #b00020; stroke-dasharray: 5 3; }
.box { stroke: #57606a; } .first .box { fill: #b8d8ec; } .second .box { fill: #f6d3a8; }
.point { fill-opacity: .75; } .first .point { fill: #0b5a8a; } .second .point { fill: #a3530b; }
.mark { font: bold 44px sans-serif; text-anchor: middle; fill: #b00020; fill-opacity: .16; }
.watermark { background: #b00020; color: #fff; font-weight: bold; padding: .5em 1em; }
.behind { position: fixed; inset: 0; display: flex; align-items: center; justify-content: center; pointer-events: none;
  font: bold 14vw sans-serif; color: #b00020; opacity: .07; transform: rotate(-30deg); }
@media print { body { max-width: none; } figure, svg { break-inside: avoid; } }
</style>
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

}  // namespace

std::string pageBegin(const std::string& title, bool synthetic) {
  std::string html = head;
  html += fmt::format("<title>{}{}</title>\n</head>\n<body>\n", synthetic ? "SYNTHETIC: " : "", escaped(title));
  if (synthetic) html += "<div class=\"behind\" aria-hidden=\"true\">SYNTHETIC</div>\n";
  return html + watermarkHtml(synthetic) + fmt::format("<h1>{}</h1>\n", escaped(title));
}

std::string pageEnd(bool synthetic) { return watermarkHtml(synthetic) + "</body>\n</html>\n"; }

std::string watermarkHtml(bool synthetic) {
  return synthetic ? fmt::format("<p class=\"watermark\">{}</p>\n", escaped(watermarkText)) : std::string();
}

std::string paragraphHtml(const std::string& text) { return fmt::format("<p>{}</p>\n", escaped(text)); }

std::string listHtml(const std::vector<std::string>& items) {
  std::string html = "<ul>\n";
  for (const std::string& item : items) html += fmt::format("<li>{}</li>\n", escaped(item));
  return html + "</ul>\n";
}

std::string tableHtml(const ReportTable& table) {
  std::vector<std::string> names;
  for (const auto& column : table.columns) names.push_back(column.first);
  std::string html = fmt::format("<h2>{}</h2>\n<div class=\"wide\"><table>\n<thead>", escaped(table.title));
  html += cells(names, table, "th") + "</thead>\n<tbody>\n";
  for (const auto& row : table.rows) html += cells(row, table, "td");
  return html + "</tbody>\n</table></div>\n";
}

}  // namespace calot::analytics
