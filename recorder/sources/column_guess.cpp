// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"
#include "recorder/sources/column_map.h"

namespace calot::recorder {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t maxGuessBytes = std::size_t{1} << 30U;

/// Files that are no text: how each begins, and what to do.
constexpr std::pair<std::string_view, const char*> foreignFiles[] = {
    {"\x89HDF\r\n", "an HDF5 file (robomimic, h5py); write times and positions of the hands as CSV, a row a sample"},
    {"PAR1", "a Parquet file (LeRobot); pandas.read_parquet(file).to_csv(name) writes it as CSV"},
    {"PK\x03\x04", "a spreadsheet or another packed file; save it as CSV"},
    {"#ROSBAG", "a ROS bag; rostopic echo -b FILE -p TOPIC > name.csv writes a topic as CSV"},
    {"SQLite format 3", "a database (a ROS 2 bag?); write the topic as CSV"},
    {"ObjectType = Image", "a sequence of PLUS or Slicer; write times and positions of its transforms as CSV"},
    {"NRRD", "a sequence of PLUS or Slicer; write times and positions of its transforms as CSV"},
};

bool isNumber(std::string_view cell) {
  return !cell.empty() && std::string_view("+-.0123456789").find(cell.front()) != std::string_view::npos &&
         cell.find_first_of("0123456789") != std::string_view::npos;
}

bool contains(std::string_view text, std::initializer_list<std::string_view> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return text.find(word) != std::string_view::npos; });
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
    const std::size_t above = header.lines() - 1;
    const auto alone = [&](const std::string& path) { return header.find(path).size() == 1; };
    if (alone(name)) return name;
    for (std::size_t l = above; l-- > 0;) {
      if (!isAbove(l)) continue;
      if (const std::string path = header.cell(l, column) + '/' + name; alone(path)) return path;
    }
    for (std::size_t l = 0; l < above; ++l) {
      for (std::size_t k = l + 1; k < above; ++k) {
        if (!isAbove(l) || !isAbove(k)) continue;
        if (const std::string path = header.cell(l, column) + '/' + header.cell(k, column) + '/' + name; alone(path))
          return path;
      }
    }
    return {};
  }
};

/// Reads lines down to the first row: its first cell is a number or a date, and three cells are.
std::optional<Heading> headingOf(std::string_view text, char delimiter) {
  Heading heading;
  heading.delimiter = delimiter;
  std::vector<std::vector<std::string>> lines;
  std::vector<std::string_view> cells;
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

/// x, y, z of one point.
struct Point {
  std::size_t x = 0;
  std::string side;                        ///< "left", "right" or empty
  std::vector<std::string> quaternion;     ///< columns w x y z, or none
  std::optional<std::size_t> status = {};  ///< column
};

class Guesser {
 public:
  explicit Guesser(Heading heading) : h_(std::move(heading)) {}

  GuessedMap guess() {
    const TableHeader& header = h_.header;
    const std::string first = lowerCase(header.cell(0, 0)), all = contextOfAll();
    motive_ = first == "format version";
    vicon_ = first == "trajectories" || first == "objects";
    ndi_ = contains(all, {" q0 "}) && contains(all, {" tx "});
    ros_ = contains(all, {"%time", "field."}) || contains(all, {"position.x"});
    result_.source = motive_  ? "CSV file of OptiTrack Motive"
                     : vicon_ ? "CSV file of Vicon"
                     : ndi_   ? "CSV file of an NDI tracker"
                     : ros_   ? "CSV file of a ROS topic"
                              : "table";
    std::vector<Point> points = pointsOf();
    map_ = {{"format", "calot-columns"}, {"formatVersion", 1}};
    if (motive_ || vicon_) map_["device"] = "optical-tracker";
    if (ndi_) map_["device"] = "ndi-tracker";
    map_["frame"] = motive_ ? "motive-global" : vicon_ ? "vicon-global" : ndi_ ? "ndi-tracker" : "world";
    const std::string length = points.empty() ? "" : lengthOf(points.front().x);
    map_["length"] = length.empty() ? leaveOpen("the unit of length") : length;
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

  [[nodiscard]] std::string contextOfAll() const {
    std::string text = " ";
    for (const std::string& name : h_.header.names()) text += lowerCase(name) + ' ';
    return text;
  }

  /// "left" or "right" where the cells say so.
  [[nodiscard]] std::string sideOf(std::size_t x) const {
    std::string context = h_.context(x);
    const std::string name = lowerCase(h_.header.names()[x]);
    const auto word = [&](const char* whole, const char* letter) {
      if (contains(context, {whole})) return true;
      for (char& c : context) {
        if (c < 'a' || c > 'z') c = ' ';
      }
      return contains(' ' + context, {fmt::format(" {} ", letter), fmt::format(" {}h ", letter)}) ||
             name == std::string(letter) + 'x';
    };
    const bool left = word("left", "l"), right = word("right", "r");
    return left == right ? "" : left ? "left" : "right";
  }

  /// Do three columns from x name the axes of one thing?
  [[nodiscard]] bool isTriple(std::size_t x) const {
    const std::vector<std::string>& names = h_.header.names();
    if (x + 2 >= names.size()) return false;
    const std::string a = lowerCase(names[x]), b = lowerCase(names[x + 1]), c = lowerCase(names[x + 2]);
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
    const std::string context = h_.context(x), name = lowerCase(h_.header.names()[x]);
    if (motive_ && (!contains(context, {"rigid body "}) || contains(context, {"marker"}))) return false;
    if (contains(context, {"rot", "quat", "orient", "angle", "euler", "vel", "acc", "twist", "angular", "force",
                           "torque", "gyro", "covariance"}) &&
        name != "tx" && !contains(name, {"position", "translation"}))
      return false;
    if (name == "rx" && contains(contextOfAll(), {" tx "})) return false;
    return name.size() != 2 || std::string_view("qvawfmg").find(name[0]) == std::string_view::npos;
  }

  /// Names of w, x, y, z among four columns, or none.
  [[nodiscard]] std::vector<std::string> quaternionAt(std::size_t from) const {
    const std::vector<std::string>& names = h_.header.names();
    std::array<std::string, 4> columns;
    if (from + 4 > names.size()) return {};
    for (std::size_t c = from; c < from + 4; ++c) {
      const std::string name = lowerCase(names[c]);
      const bool rotation =
          contains(h_.context(c), {"rot", "quat", "orient"}) || name.starts_with('q') || name.starts_with('r');
      const std::size_t axis = name.empty() ? 4 : std::string_view("wxyz0").find(name.back());
      if (!rotation || axis == std::string_view::npos) return {};
      columns[axis % 4] = h_.nameOf(c);
    }
    if (std::any_of(columns.begin(), columns.end(), [](const std::string& name) { return name.empty(); })) return {};
    return {columns.begin(), columns.end()};
  }

  [[nodiscard]] std::vector<Point> pointsOf() const {
    std::vector<Point> points;
    std::size_t end = 0;
    for (std::size_t x = 0; x + 2 < h_.header.columns(); ++x) {
      if (!isTriple(x) || !isPosition(x) || h_.nameOf(x).empty()) continue;
      Point point;
      point.x = x;
      point.side = sideOf(x);
      if (x >= 4) point.quaternion = quaternionAt(x - 4);
      if (point.quaternion.empty()) point.quaternion = quaternionAt(x + 3);
      for (std::size_t c = end; c < x; ++c) {
        if (contains(lowerCase(h_.header.names()[c]), {"state", "status"})) point.status = c;
      }
      points.push_back(point);
      x += 2;
      end = x + 1;
    }
    return points;
  }

  /// The value behind a key of the header's first line.
  [[nodiscard]] std::string stated(std::string_view key) const {
    for (std::size_t c = 0;; c += 2) {
      const std::string& name = h_.header.cell(0, c);
      if (name.empty() || c > 100) return {};
      if (lowerCase(name) == key) return h_.header.cell(0, c + 1);
    }
  }

  [[nodiscard]] std::string lengthOf(std::size_t x) const {
    if (ndi_) return "mm";
    if (ros_) return "m";
    std::string unit = lowerCase(h_.cellOf(h_.units, x));
    if (motive_) unit = lowerCase(stated("length units"));
    const std::string name = lowerCase(h_.header.names()[x]);
    for (const char open : {'[', '('}) {
      if (const std::size_t at = name.find(open); at != std::string::npos)
        unit = name.substr(at + 1, name.size() - at - 2);
    }
    for (const char* known : {"mm", "cm", "m"}) {
      if (name.ends_with(std::string("_") + known)) unit = known;
    }
    const std::pair<std::string_view, const char*> units[] = {
        {"mm", "mm"},    {"millimeters", "mm"}, {"cm", "cm"},   {"centimeters", "cm"}, {"m", "m"},
        {"meters", "m"}, {"inch", "inch"},      {"in", "inch"}, {"inches", "inch"}};
    for (const auto& [word, known] : units) {
      if (unit == word) return known;
    }
    return {};
  }

  [[nodiscard]] std::optional<std::size_t> columnLike(std::initializer_list<std::string_view> names) const {
    for (const std::string_view wanted : names) {
      for (std::size_t c = 0; c < h_.header.columns(); ++c) {
        if (lowerCase(h_.header.names()[c]) == wanted) return c;
      }
    }
    return std::nullopt;
  }

  static std::string clockUnit(const std::string& name, const std::string& cell) {
    if (cell.size() > 10 && cell[4] == '-' && cell.find(':') != std::string::npos) return "iso";
    if (cell.find(':') != std::string::npos) return "time-of-day";
    if (name == "%time" || name.starts_with("field.")) return "ns";
    const std::pair<std::string_view, const char*> units[] = {
        {"(seconds)", "s"}, {"[s]", "s"},   {"(s)", "s"},   {"_s", "s"},    {"sec", "s"},
        {"(ms)", "ms"},     {"[ms]", "ms"}, {"_ms", "ms"},  {"[us]", "us"}, {"(us)", "us"},
        {"_us", "us"},      {"[ns]", "ns"}, {"(ns)", "ns"}, {"_ns", "ns"}};
    for (const auto& [end, unit] : units) {
      if (name.ends_with(end)) return unit;
    }
    return {};
  }

  void putClock() {
    const auto seconds =
        columnLike({"timespec_s", "sec", "secs", "header.stamp.sec", "header.stamp.secs", "stamp_sec"});
    const auto nanoseconds = columnLike(
        {"timespec_ns", "nanosec", "nsec", "nsecs", "header.stamp.nanosec", "header.stamp.nsecs", "stamp_nsec"});
    if (seconds && nanoseconds && !h_.nameOf(*seconds).empty() && !h_.nameOf(*nanoseconds).empty()) {
      map_["time"] = {{"column", h_.nameOf(*seconds)}, {"unit", "s"}, {"nanoseconds", h_.nameOf(*nanoseconds)}};
      return;
    }
    std::optional<std::size_t> time =
        columnLike({"field.header.stamp", "%time", "time (seconds)", "t", "time", "timestamp"});
    for (std::size_t c = 0; !time && c < h_.header.columns(); ++c) {
      if (contains(lowerCase(h_.header.names()[c]), {"time", "stamp"})) time = c;
    }
    // A Motive table whose names line leaves the first two columns unnamed has frame and seconds there.
    const std::optional<std::size_t> frame = columnLike({"frame", "frame#", "frame number"});
    if (time && !h_.nameOf(*time).empty()) {
      const std::string cell = h_.cellOf(h_.row, *time);
      const std::string unit = clockUnit(lowerCase(h_.header.names()[*time]), cell);
      map_["time"] = {{"column", h_.nameOf(*time)}, {"unit", unit.empty() ? leaveOpen("the unit of time") : unit}};
      if (unit == "iso" && cell.find_first_of("Z+", 19) == std::string::npos && cell.find('-', 19) == std::string::npos)
        map_["time"]["zone"] = leaveOpen("the zone of its dates");
      return;
    }
    const std::string rate = motive_                           ? stated("export frame rate")
                             : vicon_ && h_.header.lines() > 1 ? h_.header.cell(1, 0)
                                                               : "";
    std::string fault;
    const double hertz = readFiniteNumber(rate, fault);
    if (frame && vicon_) map_["time"] = {{"column", h_.nameOf(*frame)}, {"unit", "frame"}};
    if (fault.empty())
      map_["rate"] = hertz;
    else
      map_["rate"] = leaveOpen("the rate of its rows (Hz), or which column has times");
  }

  void putHands(const std::vector<Point>& points) {
    const auto ofSide = [&](const char* side) {
      return std::count_if(points.begin(), points.end(), [&](const Point& p) { return p.side == side; });
    };
    const bool sided = ofSide("left") <= 1 && ofSide("right") <= 1 && ofSide("left") + ofSide("right") > 0;
    if (!sided)
      leaveOpen(points.empty()
                    ? "which columns are x, y, z of a hand"
                    : "which hand is which: call them \"left\" and \"right\", and leave out what is neither");
    std::size_t number = 0;
    for (const Point& point : points) {
      if (sided && point.side.empty()) continue;
      Json hand;
      for (std::size_t c = point.x; c < point.x + 3; ++c) hand["position"].push_back(h_.nameOf(c));
      if (!point.quaternion.empty()) hand["quaternion"] = point.quaternion;
      if (point.status && ndi_ && !h_.nameOf(*point.status).empty()) {
        hand["status"] = h_.nameOf(*point.status);
        hand["valid"] = {"OK", "Enabled"};
      }
      map_[sided ? point.side : fmt::format("?{}", ++number)] = hand;
    }
  }

  Heading h_;
  bool motive_ = false, vicon_ = false, ndi_ = false, ros_ = false;
  Json map_;
  GuessedMap result_;
};

}  // namespace

GuessedMap guessColumns(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return guessColumns(readFileBytes(file, name, maxGuessBytes), name);
}

GuessedMap guessColumns(std::span<const std::byte> bytes, const std::string& file) {
  const std::string_view raw(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const auto& [begin, what] : foreignFiles) {
    if (raw.starts_with(begin)) throw Error(ErrorKind::damaged, Where{file}, fmt::format("is {}", what));
  }
  constexpr std::size_t enough = std::size_t{1} << 20U;  // for a header
  std::string converted;
  const std::string_view text = decodedText(bytes.first(std::min(bytes.size(), enough)), converted);
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
