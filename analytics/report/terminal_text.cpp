// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/terminal_text.h"

#include <fmt/format.h>
#include <algorithm>
#include <ios>
#include <iterator>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

namespace calot::analytics {
namespace {

constexpr std::size_t narrowest = 10, fileColumns = 120;
/// On a terminal, texts of more columns than the first are not given fewer than the second.
constexpr std::size_t prose = 40, readable = 24;

/// The slot in which a stream keeps its terminal's columns; 0 without a terminal.
int columnsIndex() {
  static const int index = std::ios_base::xalloc();
  return index;
}
std::size_t terminalOf(std::ostream& out) { return static_cast<std::size_t>(out.iword(columnsIndex())); }

bool isUnit(std::string_view word) {
  constexpr std::string_view units[] = {"%", "s",  "ms", "m",    "cm",   "mm",  "ml",
                                        "N", "Hz", "x",  "cm^2", "mm/s", "N/s", "deg"};
  word = word.substr(0, word.find_last_not_of(".,;:)") + 1);
  return std::find(std::begin(units), std::end(units), word) != std::end(units);
}

/// Neither a number and its unit nor the ends of an interval stand on two lines.
bool belongsTo(std::string_view before, std::string_view word) {
  if (before.empty()) return false;
  if (before.front() == '[' && before.back() == ',') return true;
  return before.back() >= '0' && before.back() <= '9' && isUnit(word);
}

std::string_view withoutBlanks(std::string_view word) {
  return word.substr(std::min(word.find_first_not_of(' '), word.size()));
}

/// Words of a text, each with the blanks before it.
std::vector<std::string> splitWords(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = text.find_first_not_of(' ', at);
    if (begin == std::string::npos) break;
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(at, end - at);
    if (!words.empty() && belongsTo(withoutBlanks(words.back()), withoutBlanks(word))) {
      words.back() += word;
    } else {
      words.push_back(word);
    }
    at = end;
  }
  return words;
}

}  // namespace

void setTerminalColumns(std::ostream& out, std::size_t columns) {
  out.iword(columnsIndex()) = static_cast<long>(columns);
}

std::string wrappedText(const std::string& text, std::size_t columns, std::size_t indent, std::size_t used) {
  const std::string below = '\n' + std::string(indent, ' ');
  std::string out;
  std::istringstream lines(text);
  bool first = true;
  for (std::string line; std::getline(lines, line); first = false) {
    if (!first) out += below;
    std::size_t at = first ? used : indent;
    bool empty = true;
    for (const std::string& word : splitWords(line)) {
      const std::size_t width = columnsOf(word);
      if (!empty && at + width > columns) {
        const std::string_view alone = withoutBlanks(word);
        out += below;
        out += alone;
        at = indent + width - (word.size() - alone.size());
      } else {
        out += word;
        at += width;
      }
      empty = false;
    }
  }
  return out;
}

namespace {

/// How far columns are made narrower, one after the other.
enum class Narrowing { wholeWords, othersCut, allCut };

/// With the two blanks before it that a line below has.
std::size_t longestWord(const std::string& text) {
  std::size_t longest = 0;
  bool first = true;
  for (const std::string& word : splitWords(text)) {
    longest = std::max(longest, first ? columnsOf(word) : columnsOf(std::string(withoutBlanks(word))) + 2);
    first = false;
  }
  return longest;
}

/// The text broken at blanks into lines, those below the first indented; a word longer than a line is cut.
std::vector<std::string> cellLines(const std::string& text, std::size_t width) {
  if (columnsOf(text) <= width) return {text};
  std::vector<std::string> lines;
  for (const std::string& word : splitWords(text)) {
    if (lines.empty()) {
      lines.push_back(word);  // what is indented stays so
    } else if (columnsOf(lines.back()) + columnsOf(word) <= width) {
      lines.back() += word;
    } else {
      lines.push_back("  " + std::string(withoutBlanks(word)));
    }
  }
  for (std::string& line : lines) line = cutTo(line, width);
  return lines;
}

/// The columns that a text shows of a table, and how wide they are.
class TableLayout {
 public:
  TableLayout(const ReportTable& table, bool onTerminal)
      : table_(table), natural_(table.columns.size()), least_(table.columns.size()), shown_(table.columns.size()) {
    for (std::size_t c = 0; c < natural_.size(); ++c) {
      natural_[c] = columnsOf(table.columns[c].first);
      least_[c] = std::max(narrowest, natural_[c]);
      for (const auto& row : table.rows) {
        natural_[c] = std::max(natural_[c], columnsOf(row[c]));
        least_[c] = std::max(least_[c], longestWord(row[c]));
        shown_[c] = shown_[c] || !row[c].empty();
      }
      if (onTerminal && natural_[c] > prose) least_[c] = std::max(least_[c], readable);
    }
    width = natural_;
  }

  [[nodiscard]] bool isShown(std::size_t column) const { return shown_[column]; }

  [[nodiscard]] std::size_t total() const {
    std::size_t sum = 0;
    for (std::size_t c = 0; c < width.size(); ++c) sum += shown_[c] ? width[c] + (sum == 0 ? 0 : 2) : 0;
    return sum;
  }

  /// Words are cut where nothing else helps, and those that say what a row is last.
  void narrow(std::size_t most, Narrowing to) {
    while (total() > most) {
      std::size_t widest = width.size();
      for (std::size_t c = 0; c < width.size(); ++c) {
        const bool whole = to == Narrowing::wholeWords || (to == Narrowing::othersCut && c == 0);
        if (!shown_[c] || table_.columns[c].second != Align::left || width[c] <= (whole ? least_[c] : narrowest))
          continue;
        if (widest == width.size() || width[c] > width[widest]) widest = c;
      }
      if (widest == width.size()) return;
      --width[widest];
    }
  }

  /// Leaves columns out until words are whole. @return whether each column was left out
  std::vector<bool> leaveOut(std::size_t most) {
    std::vector<bool> left(width.size(), false);
    std::size_t next = 0;
    for (narrow(most, Narrowing::wholeWords); total() > most; narrow(most, Narrowing::wholeWords)) {
      std::optional<std::size_t> column;
      while (!column && next < table_.leastNeeded.size()) {
        column = lastShown(&table_.leastNeeded[next]);
        if (!column) ++next;
      }
      if (!column) column = lastShown(nullptr);
      if (!column) break;
      shown_[*column] = false;
      left[*column] = true;
      width = natural_;
    }
    return left;
  }

  std::vector<std::size_t> width;

 private:
  /// The last column of a title but for the first, or of any title but for the first two.
  [[nodiscard]] std::optional<std::size_t> lastShown(const std::string* title) const {
    std::optional<std::size_t> last;
    const std::size_t kept = title != nullptr ? 1 : 2;
    std::size_t before = 0;
    for (std::size_t c = 0; c < shown_.size(); ++c) {
      if (!shown_[c] || before++ < kept) continue;
      if (title == nullptr || table_.columns[c].first == *title) last = c;
    }
    return last;
  }

  const ReportTable& table_;
  std::vector<std::size_t> natural_, least_;
  std::vector<bool> shown_;
};

void printLeftOut(const ReportTable& table, const std::vector<bool>& left, std::size_t columns, std::ostream& out) {
  std::string names;
  for (std::size_t c = 0; c < left.size(); ++c) {
    if (!left[c]) continue;
    const std::string& title = table.columns[c].first;
    names += (names.empty() ? "" : ", ") + (title.empty() ? "remarks" : title);
  }
  if (names.empty()) return;
  printWrapped(
      fmt::format("Columns left out to fit {} characters: {}. A wider terminal shows them, and so does a file.",
                  columns, names),
      out);
}

}  // namespace

void ReportTable::print(std::ostream& out, std::size_t most) const {
  const std::size_t terminal = terminalOf(out);
  if (terminal > 0) most = terminal;
  TableLayout layout(*this, terminal > 0);
  std::vector<bool> left;
  if (terminal > 0) left = layout.leaveOut(most);
  for (const Narrowing to : {Narrowing::wholeWords, Narrowing::othersCut, Narrowing::allCut}) layout.narrow(most, to);
  const std::vector<std::size_t>& width = layout.width;
  const auto line = [&](const auto& cell, char fill) {
    std::string text;
    bool first = true;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      if (!layout.isShown(c)) continue;
      if (!first) text += "  ";
      first = false;
      const std::string content = cutTo(cell(c), width[c]);
      const std::string padding(width[c] - std::min(width[c], columnsOf(content)), fill);
      text += columns[c].second == Align::left ? content + padding : padding + content;
    }
    text.erase(text.find_last_not_of(' ') + 1);
    out << text << '\n';
  };
  line([&](std::size_t c) { return columns[c].first; }, ' ');
  line([](std::size_t) { return std::string(); }, '-');
  // The rest of cells that are too wide goes on below: in the next row if it belongs to this one (its first
  // cell is empty) and has an empty cell there, else in a line of its own.
  std::vector<std::vector<std::string>> rest(columns.size());
  const auto takeRest = [&](std::size_t c) {
    if (rest[c].empty()) return std::string();
    std::string text = rest[c].front();
    rest[c].erase(rest[c].begin());
    return text;
  };
  const auto printRest = [&](const auto& wanted) {
    const auto waits = [&](std::size_t c) { return !rest[c].empty() && wanted(c); };
    for (bool any = true; any;) {
      any = false;
      for (std::size_t c = 0; c < columns.size(); ++c) any = any || waits(c);
      if (any) line([&](std::size_t c) { return waits(c) ? takeRest(c) : std::string(); }, ' ');
    }
  };
  for (const auto& row : rows) {
    printRest([&](std::size_t c) { return !row[0].empty() || !row[c].empty(); });
    line(
        [&](std::size_t c) {
          if (row[c].empty() || columns[c].second != Align::left) return row[c].empty() ? takeRest(c) : row[c];
          rest[c] = cellLines(row[c], width[c]);
          return takeRest(c);
        },
        ' ');
  }
  printRest([](std::size_t) { return true; });
  printLeftOut(*this, left, most, out);
}

void printTable(const ReportTable& table, std::ostream& out) {
  printWrapped(table.title, out);
  table.print(out, fileColumns);
  out << '\n';
}

void printWrapped(const std::string& text, std::ostream& out) {
  const std::size_t terminal = terminalOf(out);
  out << wrappedText(text, terminal > 0 ? std::min(terminal, fileColumns) : fileColumns) << '\n';
}

void printReport(const ReportOpening& opening, std::ostream& out, const std::function<void()>& body) {
  if (opening.synthetic) out << watermarkText << '\n';
  printWrapped(opening.title, out);
  for (const std::string& line : opening.head) printWrapped(line, out);
  out << '\n';
  if (!opening.flow.rows.empty()) printTable(opening.flow, out);
  body();
  if (opening.synthetic) out << watermarkText << '\n';
}

void printDocument(const ReportDocument& document, std::ostream& out) {
  const auto textOf = [](const Paragraph& paragraph) {
    std::string text;
    for (const TextSpan& span : paragraph) text += span.text;
    return text;
  };
  printReport({document.title, document.synthetic, {}, {}}, out, [&] {
    for (const auto& part : document.parts) {
      if (const auto* heading = std::get_if<Heading>(&part)) out << heading->text << '\n';
      if (const auto* table = std::get_if<ReportTable>(&part)) printTable(*table, out);
      if (const auto* paragraph = std::get_if<Paragraph>(&part)) {
        printWrapped(textOf(*paragraph), out);
        out << '\n';
      }
      if (const auto* list = std::get_if<BulletList>(&part)) {
        for (const Paragraph& item : list->items) printWrapped("- " + textOf(item), out);
      }
    }
  });
}

}  // namespace calot::analytics
