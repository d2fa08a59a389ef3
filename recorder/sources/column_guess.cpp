// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"
#include "recorder/recording/demonstrations.h"
#include "recorder/sources/column_map.h"
#include "recorder/sources/motion_formats.h"
#include "recorder/sources/motion_text.h"

namespace calot::recorder {
namespace motion_formats {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t headerBytes = std::size_t{1} << 20U;  ///< enough for a header

bool isNumber(Text cell) {
  return cell.find_first_of("+-.0123456789") == 0 && cell.find_first_of("0123456789") != Text::npos;
}

/// Calls `is` with the parts of a text. @return whether any was
bool any(Text text, char separator, const auto& is) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    if (is(text.substr(0, end))) return true;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return false;
}

bool contains(Text text, Text parts) {
  return any(parts, '|',
             [&](Text all) { return !any(all, '&', [&](Text part) { return text.find(part) == Text::npos; }); });
}

/// The header of a table, and its first row.
struct Heading {
  char delimiter = ',';
  TableHeader header;
  std::vector<std::string> units, row;

  [[nodiscard]] std::string cellOf(const std::vector<std::string>& line, std::size_t column) const {
    return column < line.size() ? line[column] : std::string();
  }
  /// Does a line belong to the columns? Others state facts of the whole file.
  [[nodiscard]] bool isAbove(std::size_t line) const {
    return line + 1 == header.lines() || header.cell(line, 0).empty();
  }
  /// All cells above a column and its name, in small letters.
  [[nodiscard]] std::string context(std::size_t column) const {
    std::string text;
    for (std::size_t l = 0; l < header.lines(); ++l) {
      if (isAbove(l)) text += lowerCase(header.cell(l, column)) + ' ';
    }
    return text;
  }
  /// The shortest name that is the column's alone; empty: there is none.
  [[nodiscard]] std::string nameOf(std::size_t column) const {
    const std::string& name = header.names()[column];
    std::vector<std::string> paths{name}, above;
    for (std::size_t l = header.lines() - 1; l-- > 0;) {
      if (isAbove(l)) above.push_back(header.cell(l, column) + '/');
    }
    for (const std::string& cell : above) paths.push_back(cell + name);
    for (std::size_t l = above.size(); l-- > 0;) {
      for (std::size_t k = l; k-- > 0;) paths.push_back(above[l] + above[k] + name);
    }
    const auto alone = [&](const std::string& path) { return header.find(path).size() == 1; };
    const auto found = std::find_if(paths.begin(), paths.end(), alone);
    return found == paths.end() ? std::string() : *found;
  }
};

/// Reads lines down to the first row: its first cell is a number or a date, and three cells are.
std::optional<Heading> headingOf(Text text, char delimiter) {
  Heading heading{delimiter, {}, {}, {}};
  std::vector<std::vector<std::string>> lines;
  std::vector<Text> cells;
  for (std::size_t l = 0; l <= maxHeaderLines && !text.empty(); ++l) {
    splitCells(takeLine(text), delimiter, cells);
    const auto numbers = static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), isNumber));
    if (l > 0 && numbers >= 3 && isNumber(cells.front())) {
      heading.row.assign(cells.begin(), cells.end());
      break;
    }
    lines.emplace_back(cells.begin(), cells.end());
  }
  if (lines.empty() || heading.row.empty()) return std::nullopt;
  if (lines.size() > 1 && lines.back().front().empty() && lines[lines.size() - 2].size() > 3) {
    heading.units = lines.back();
    lines.pop_back();
  }
  for (const std::vector<std::string>& line : lines) heading.header.add({line.begin(), line.end()});
  return heading;
}

struct Point {
  std::size_t x = 0;  ///< first column of its position
  std::string side;   ///< "left", "right" or empty
  Json hand;          ///< of the map
};

class Guesser {
 public:
  explicit Guesser(Heading heading) : h_(std::move(heading)), names_(h_.header.columns()) {
    for (std::size_t c = 0; c < names_.size(); ++c) all_ += (names_[c] = lowerCase(h_.header.names()[c])) + ' ';
    const std::string first = lowerCase(h_.header.cell(0, 0));
    const auto looks = [&](const Format& format) {
      const auto isFirst = [&](Text word) { return first == word; };
      return (format.first.empty() || any(format.first, '|', isFirst)) &&
             (format.names.empty() || contains(all_, format.names));
    };
    f_ = *std::find_if(std::begin(formats), std::end(formats), looks);
  }

  GuessedMap guess() {
    result_.source = f_.source;
    std::vector<Point> points = pointsOf();
    map_ = {{"format", "calot-columns"}, {"formatVersion", 1}};
    if (!f_.device.empty()) map_["device"] = f_.device;
    map_["frame"] = f_.frame;
    const std::string length = points.empty() ? "" : lengthOf(points.front().x);
    map_["length"] = length.empty() ? leaveOpen("the unit of length") : length;
    if (const std::string count = stated("@demonstrations"); count != "" && count != "1")
      map_["demonstration"] = leaveOpen(fmt::format("which of its {} demonstrations", count));
    if (h_.delimiter != ',') map_["delimiter"] = h_.delimiter == ';' ? ";" : "tab";
    putClock();
    putHands(points);
    map_["notes"] = {"read as " + result_.source};
    for (const std::string& open : result_.open) map_["notes"].push_back("\"?\": the file does not say " + open);
    result_.json = map_.dump(1, ' ', false, Json::error_handler_t::replace);
    return std::move(result_);
  }

 private:
  std::string leaveOpen(const std::string& what) {
    result_.open.push_back(what);
    return "?";
  }

  /// "left" or "right" where the cells say so.
  [[nodiscard]] std::string sideOf(std::size_t x) const {
    std::string context = h_.context(x);
    const auto word = [&](Text whole, char letter) {
      if (contains(context, whole)) return true;
      for (char& c : context) {
        if (c < 'a' || c > 'z') c = ' ';
      }
      return contains(' ' + context, fmt::format(" {0} | {0}h ", letter)) || names_[x] == fmt::format("{}x", letter);
    };
    const bool left = word("left|psml", 'l'), right = word("right|psmr", 'r');
    return left == right ? "" : left ? "left" : "right";
  }

  /// Do three columns from x name the axes of one thing?
  [[nodiscard]] bool isTriple(std::size_t x) const {
    if (x + 2 >= names_.size()) return false;
    const std::string &a = names_[x], &b = names_[x + 1], &c = names_[x + 2];
    if (a.size() != b.size() || a.size() != c.size()) return false;
    std::size_t differing = 0, at = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a[i] == b[i] && a[i] == c[i]) continue;
      ++differing;
      at = i;
    }
    return differing == 1 && a[at] == 'x' && b[at] == 'y' && c[at] == 'z';
  }

  [[nodiscard]] bool isPosition(std::size_t x) const {
    const std::string context = h_.context(x), &name = names_[x];
    if (!f_.bodies.empty() && !contains(context, f_.bodies)) return false;
    if (contains(context, f_.others)) return false;
    if (contains(context, notPositions) && name != "tx" && !contains(name, "position|translation")) return false;
    if (name == "rx" && contains(all_, " tx ")) return false;
    return name.size() != 2 || Text("qvawfmg").find(name[0]) == Text::npos;
  }

  /// Shortest names of columns; none where one has none of its own.
  [[nodiscard]] Json namesOf(std::size_t from, std::size_t count) const {
    Json names = Json::array();
    for (std::size_t c = from; c < from + count; ++c) {
      names.push_back(c < names_.size() ? h_.nameOf(c) : std::string());
      if (names.back() == "") return {};
    }
    return names;
  }

  /// Names of w, x, y, z among four columns, or none.
  [[nodiscard]] Json quaternionAt(std::size_t from) const {
    const Json given = namesOf(from, 4);
    Json columns = {"", "", "", ""};
    if (given.is_null()) return {};
    for (std::size_t c = from; c < from + 4; ++c) {
      const std::string& name = names_[c];
      const bool rotation =
          contains(h_.context(c), "rot|quat|orient") || name.starts_with('q') || name.starts_with('r');
      const std::size_t axis = name.empty() ? Text::npos : Text("wxyz0").find(name.back());
      if (!rotation || axis == Text::npos) return {};
      columns[axis % 4] = given[c - from];
    }
    return std::find(columns.begin(), columns.end(), "") == columns.end() ? columns : Json();
  }

  /// Letters with which what is above two columns, and their names, begin alike.
  [[nodiscard]] std::ptrdiff_t agreement(std::size_t a, std::size_t b) const {
    const std::string one = h_.context(a), other = h_.context(b);
    return std::mismatch(one.begin(), one.end(), other.begin(), other.end()).first - one.begin();
  }

  /// The orientation beside a position. Columns r11 to r33 are a matrix wherever they are.
  /// @param free first column that is no other hand's @return the same behind it
  std::size_t putRotation(std::size_t x, std::size_t free, Json& hand) const {
    const bool named = x + 11 < names_.size() && names_[x + 3].ends_with("r11") && names_[x + 11].ends_with("r33");
    const Json matrix = named || f_.rotation == "matrix" ? namesOf(x + 3, 9) : Json();
    const Json angles = f_.rotation.size() == 3 ? namesOf(x + 3, 3) : Json();
    Json quaternion = x >= free + 4 ? quaternionAt(x - 4) : Json();
    const Json behind = quaternionAt(x + 3);
    if (!quaternion.is_null() && agreement(x, x - 4) == 0 && !names_[x - 4].starts_with('q')) quaternion = {};
    const bool isBehind = !behind.is_null() && (quaternion.is_null() || agreement(x, x + 3) > agreement(x, x - 4));
    if (isBehind) quaternion = behind;
    if (!matrix.is_null()) {
      hand["matrix"] = matrix;
    } else if (!angles.is_null()) {
      hand["angles"] = angles;
      hand["order"] = f_.rotation;
    } else if (!quaternion.is_null()) {
      hand["quaternion"] = quaternion;
    }
    return x + (!matrix.is_null() ? 12 : !angles.is_null() ? 6 : isBehind ? 7 : 3);
  }

  /// Hands with their columns, by their first one. A state stands before its pose.
  [[nodiscard]] std::vector<Point> pointsOf() const {
    std::vector<Point> points;
    std::size_t end = 0;
    for (std::size_t x = 0; x + 2 < names_.size(); ++x) {
      if (!isTriple(x) || !isPosition(x) || h_.nameOf(x).empty()) continue;
      Point point{x, sideOf(x), {}};
      point.hand["position"] = namesOf(x, 3);
      const std::size_t free = putRotation(x, end, point.hand);
      for (std::size_t c = end; c < x && !f_.valid.empty(); ++c) {
        if (contains(names_[c], "state|status") && !h_.nameOf(c).empty()) point.hand["status"] = h_.nameOf(c);
      }
      if (point.hand.contains("status"))
        any(f_.valid, '|', [&](Text word) { return point.hand["valid"].push_back(word), false; });
      any(f_.jaw, '|', [&](Text jaw) {
        const auto column = columnLike(names_[x].substr(0, names_[x].find('_') + 1) + std::string(jaw));
        if (column) point.hand["jaw"] = h_.nameOf(*column);
        return column.has_value();
      });
      points.push_back(std::move(point));
      x += 2;
      end = free;
    }
    return points;
  }

  /// Text that a format states as "@" and a key: the cell behind the key in the first line; as "#": the second line.
  [[nodiscard]] std::string stated(Text what) const {
    if (what == "#") return h_.header.lines() > 1 ? h_.header.cell(1, 0) : std::string();
    if (!what.starts_with('@')) return std::string(what);
    for (std::size_t c = 0; c < 100 && !h_.header.cell(0, c).empty(); c += 2) {
      if (lowerCase(h_.header.cell(0, c)) == what.substr(1)) return lowerCase(h_.header.cell(0, c + 1));
    }
    return {};
  }

  [[nodiscard]] std::string lengthOf(std::size_t x) const {
    std::string unit = f_.length.empty() ? lowerCase(h_.cellOf(h_.units, x)) : stated(f_.length);
    const std::string& name = names_[x];
    if (const std::size_t at = name.find_first_of("[("); f_.length.empty() && at != std::string::npos)
      unit = name.substr(at + 1, name.size() - at - 2);
    for (const auto& [word, known] : lengthUnits) {
      if (unit == word || (f_.length.empty() && name.ends_with('_' + std::string(known)))) return std::string(known);
    }
    return {};
  }

  [[nodiscard]] std::optional<std::size_t> columnLike(Text names) const {
    std::optional<std::size_t> found;
    any(names, '|', [&](Text name) {
      const auto column = std::find(names_.begin(), names_.end(), name);
      if (column != names_.end()) found = static_cast<std::size_t>(column - names_.begin());
      return found.has_value();
    });
    return found && !h_.nameOf(*found).empty() ? found : std::nullopt;
  }

  std::string clockUnit(const std::string& name, const std::string& cell) {
    if (cell.size() > 10 && cell[4] == '-' && cell.find(':') != std::string::npos) return "iso";
    if (cell.find(':') != std::string::npos) return "time-of-day";
    if (!f_.clock.empty()) return std::string(f_.clock);
    for (const auto& [end, unit] : timeUnits) {
      if (name.ends_with(end)) return std::string(unit);
    }
    return leaveOpen("the unit of time");
  }

  void putClock() {
    const auto whole = columnLike(seconds), part = columnLike(nanoseconds), frame = columnLike(frames);
    if (whole && part) {
      map_["time"] = {{"column", h_.nameOf(*whole)}, {"unit", "s"}, {"nanoseconds", h_.nameOf(*part)}};
      return;
    }
    std::optional<std::size_t> time = columnLike(clocks);
    for (std::size_t c = 0; !time && c < names_.size(); ++c) {
      if (contains(names_[c], "time|stamp") && !h_.nameOf(c).empty()) time = c;
    }
    if (time) {
      const std::string cell = h_.cellOf(h_.row, *time), unit = clockUnit(names_[*time], cell);
      map_["time"] = {{"column", h_.nameOf(*time)}, {"unit", unit}};
      if (unit == "iso" && cell.find_first_of("Z+-", 19) == std::string::npos)
        map_["time"]["zone"] = leaveOpen("the zone of its dates");
      return;
    }
    if (frame && f_.clock == "frame") map_["time"] = {{"column", h_.nameOf(*frame)}, {"unit", "frame"}};
    std::string fault;
    const double hertz = readFiniteNumber(stated(f_.rate), fault);
    if (fault.empty())
      map_["rate"] = hertz;
    else
      map_["rate"] = leaveOpen("the rate of its rows (Hz), or which column has times");
  }

  void putHands(const std::vector<Point>& points) {
    const auto ofSide = [&](Text side) {
      return std::count_if(points.begin(), points.end(), [&](const Point& p) { return p.side == side; });
    };
    const bool sided = ofSide("left") <= 1 && ofSide("right") <= 1 && ofSide("left") + ofSide("right") > 0;
    if (!sided)
      leaveOpen(points.empty()
                    ? "which columns are x, y, z of a hand"
                    : "which hand is which: call them \"left\" and \"right\", and leave out what is neither");
    std::size_t number = 0;
    std::optional<std::string> frame;
    for (const Point& point : points) {
      if (sided && point.side.empty()) continue;
      map_[sided ? point.side : fmt::format("?{}", ++number)] = point.hand;
      const std::string& above = h_.header.cell(0, point.x);
      frame = !frame || *frame == above ? above : std::string();
    }
    if (!f_.frame.ends_with('^')) return;
    const bool one = frame && !frame->empty();
    map_["frame"] =
        one ? std::string(f_.frame.substr(0, f_.frame.size() - 1)) + *frame : leaveOpen("one frame of both hands");
  }

  Heading h_;
  std::vector<std::string> names_;  ///< in small letters
  std::string all_ = " ";           ///< with blanks between
  Format f_;
  Json map_;
  GuessedMap result_;
};

}  // namespace
}  // namespace motion_formats

GuessedMap guessColumns(const std::filesystem::path& file) {
  using motion_formats::headerBytes;
  const std::string name = file.filename().string();
  std::string begin(headerBytes + 1, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(in.gcount()));
  if (begin.empty()) throw Error(ErrorKind::damaged, Where{name}, "cannot be read, or is empty");
  if (isDemonstrations(begin)) return guessColumns(readFileBytes(file, name, maxMotionBytes), name);
  return guessColumns(std::as_bytes(std::span(begin)), name);
}

ColumnMap recognisedMap(const std::filesystem::path& file) {
  const GuessedMap guess = guessColumns(file);
  if (!guess.open.empty())
    throw Error(ErrorKind::invalid, Where{file.string()},
                fmt::format("seems to be a {} that does not say {}", guess.source, fmt::join(guess.open, ", ")));
  ColumnMap map = parseColumnMap(std::as_bytes(std::span(guess.json)), file.filename().string());
  map.source = guess.source;
  return map;
}

GuessedMap guessColumns(std::span<const std::byte> bytes, const std::string& file) {
  using namespace motion_formats;
  Text text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (!isDemonstrations(text) && text.size() > headerBytes)
    text = text.substr(0, text.substr(0, headerBytes).rfind('\n') + 1);
  std::string converted;
  text = motionText(bytes.first(text.size()), file, std::nullopt, converted);
  std::optional<Heading> best;
  for (const char delimiter : {',', ';', '\t'}) {
    std::optional<Heading> heading = headingOf(text, delimiter);
    if (heading && (!best || heading->header.columns() > best->header.columns())) best = std::move(heading);
  }
  if (!best)
    throw Error(ErrorKind::damaged, Where{file},
                "is no table of motion: names of columns, then rows of numbers between commas, semicolons or tabs, are "
                "expected");
  return Guesser(*std::move(best)).guess();
}

}  // namespace calot::recorder
