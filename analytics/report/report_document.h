// SPDX-License-Identifier: GPL-3.0-or-later
// A report as an ordered list of parts, shown identically on a terminal, by a page (page_html.h) and on paper
// (gui/report).
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "analytics/report/drawing.h"
#include "analytics/report/report_text.h"

namespace calot::analytics {

struct ReportTable {
  std::string title;
  std::vector<std::pair<std::string, TextTable::Align>> columns;
  std::vector<std::vector<std::string>> rows;
};

/// Leaves out columns of which every cell is empty.
void dropEmptyColumns(ReportTable& table);

/// Title, table and an empty line, for a terminal of 120 columns.
void printTable(const ReportTable& content, std::ostream& out);
/// A sentence over as many lines as it needs.
void printWrapped(const std::string& text, std::ostream& out);

struct TextSpan {
  std::string text;
  std::string link;  ///< where it leads, or empty
};
using Paragraph = std::vector<TextSpan>;

struct Heading {
  std::string text;
  bool newPage = false;  ///< begins a page where the report is printed
};
struct BulletList {
  std::vector<Paragraph> items;
};
struct Figures {
  std::vector<Drawing> drawings;
};

struct ReportDocument {
  std::string title;
  bool synthetic = false;  ///< watermarked: performers' figures are in it
  std::vector<std::variant<Heading, Paragraph, BulletList, ReportTable, Figures>> parts;

  void add(std::string paragraph) { parts.emplace_back(Paragraph{{std::move(paragraph), {}}}); }
  void addList(const std::vector<std::string>& items) {
    BulletList list;
    for (const std::string& item : items) list.items.push_back({{item, {}}});
    parts.emplace_back(std::move(list));
  }
};

/// Watermark of everything that contains performers' figures.
inline constexpr const char* watermarkText = "SYNTHETIC: made by performers, says nothing about people";

}  // namespace calot::analytics
