// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/motion_text.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/recording/demonstrations.h"
#include "recorder/sources/motion_table.h"

namespace calot::recorder {
namespace {

/// Files that are no text: how each begins, and what to do.
constexpr std::pair<std::string_view, const char*> foreignFiles[] = {
    {"PAR1", "a Parquet file (LeRobot); pandas.read_parquet(file).to_csv(name) writes it as CSV"},
    {"PK\x03\x04", "a spreadsheet or another packed file; save it as CSV"},
    {"#ROSBAG", "a ROS bag; rostopic echo -b FILE -p TOPIC > name.csv writes a topic as CSV"},
    {"SQLite format 3", "a database (a ROS 2 bag?); write the topic as CSV"},
};

constexpr std::string_view sequenceStarts[] = {"ObjectType = Image", "NRRD"};

std::string_view stripped(std::string_view text) {
  const std::size_t from = std::min(text.find_first_not_of(" \t\r"), text.size());
  return text.substr(from, text.find_last_not_of(" \t\r") + 1 - from);
}

/// Sequences: a line "Seq_Frame0000_NAME = VALUE" (NRRD: ":=") for each field of a frame.
class SequenceText {
 public:
  explicit SequenceText(std::string_view text) {
    constexpr std::string_view prefix = "Seq_Frame";
    while (!text.empty()) {
      const std::string_view line = stripped(takeLine(text));
      const std::size_t equals = line.find('=');
      if (text.empty() || line.empty() || line.starts_with("ElementDataFile")) return;  // pixels follow
      const std::size_t name = line.find('_', prefix.size());
      if (!line.starts_with(prefix) || equals == std::string_view::npos || name > equals) continue;
      std::string_view key = line.substr(name + 1, equals - name - 1);
      if (key.ends_with(':')) key.remove_suffix(1);
      put(line.substr(prefix.size(), name - prefix.size()), stripped(key), stripped(line.substr(equals + 1)));
    }
  }

  [[nodiscard]] std::string table() const {
    std::string frames, names = "Timestamp", rows;
    for (const std::string& name : transforms_) {
      frames += ',' + name.substr(name.rfind("To") + 2) + ",,,,,,,,,,,,";
      for (const char* column :
           {"status", "x", "y", "z", "r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"})
        names += fmt::format(",{}_{}", name, column);
    }
    for (const auto& [frame, row] : frames_) {
      rows += row.time;
      for (const std::string& name : transforms_) {
        std::array<std::string_view, 16> cells{};
        const auto found = row.transforms.find(name);
        if (found != row.transforms.end()) {
          Words words(found->second.matrix);
          for (std::string_view& cell : cells) cell = words.next();
        }
        rows += fmt::format(",{}", found == row.transforms.end() ? "" : found->second.status);
        for (const std::size_t i : {3U, 7U, 11U, 0U, 1U, 2U, 4U, 5U, 6U, 8U, 9U, 10U})
          rows += fmt::format(",{}", cells[i]);
      }
      rows += '\n';
    }
    return fmt::format("Sequence{}\n{}\n{}", frames, names, rows);
  }

 private:
  struct Transform {
    std::string_view matrix, status;
  };
  struct Frame {
    std::string_view time;
    std::map<std::string, Transform> transforms;
  };

  void put(std::string_view number, std::string_view key, std::string_view value) {
    std::uint64_t frame = 0;
    const auto [end, code] = std::from_chars(number.data(), number.data() + number.size(), frame);
    if (code != std::errc() || end != number.data() + number.size()) return;
    if (key == "Timestamp") frames_[frame].time = value;
    const bool status = key.ends_with("TransformStatus");
    if (!status && !key.ends_with("Transform")) return;
    const std::string name(key.substr(0, key.rfind("Transform")));
    if (name.find("To") == std::string::npos || name.find_first_of(",\"") != std::string::npos) return;
    if (std::find(transforms_.begin(), transforms_.end(), name) == transforms_.end()) transforms_.push_back(name);
    (status ? frames_[frame].transforms[name].status : frames_[frame].transforms[name].matrix) = value;
  }

  std::vector<std::string> transforms_;
  std::map<std::uint64_t, Frame> frames_;
};

constexpr std::size_t mostStations = 16;
constexpr std::array<const char*, 6> poseNames{"x", "y", "z", "azimuth", "elevation", "roll"};

/// Poses of a tracker's stations, record by record, as rows of samples.
class StationTable {
 public:
  /// @param sample that the records of a row share; empty: a row ends where a station comes again
  void add(std::size_t station, std::string_view sample, std::string_view time,
           std::span<const std::string_view> pose) {
    const bool again = rows_.empty() || !rows_.back().pose[station].empty();
    if (again || sample != rows_.back().sample) rows_.push_back({sample, time, {}});
    std::string& cells = rows_.back().pose[station];
    for (const std::string_view cell : pose) cells += fmt::format(",{}", cell);
    seen_[station] = true;
  }

  [[nodiscard]] std::string text(bool timed) const {
    std::string out = timed ? "Polhemus\nsample,timestamp" : "Polhemus\nsample";
    for (std::size_t s = 0; s < mostStations; ++s) {
      for (std::size_t i = 0; seen_[s] && i < poseNames.size(); ++i)
        out += fmt::format(",station{}_{}", s + 1, poseNames[i]);
    }
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      out += fmt::format("\n{}", i);
      if (timed) out += fmt::format(",{}", rows_[i].time);
      for (std::size_t s = 0; s < mostStations; ++s) {
        if (seen_[s]) out += rows_[i].pose[s].empty() ? std::string(",,,,,,") : rows_[i].pose[s];
      }
    }
    return out + '\n';
  }

 private:
  struct Row {
    std::string_view sample, time;
    std::array<std::string, mostStations> pose;
  };
  std::vector<Row> rows_;
  std::array<bool, mostStations> seen_{};
};

/// Station of 01 to 16, from 0.
bool readStation(std::string_view text, std::size_t& station) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), station);
  return code == std::errc() && end == text.data() + text.size() && station-- >= 1 && station < mostStations;
}

/// A record of FASTRAK and Liberty as they send it by default: "0", station, error code, then x, y, z, azimuth,
/// elevation and roll in fields of fixed width, between which a sign may be the only mark.
bool readRecord(std::string_view line, std::size_t& station, std::array<std::string_view, 6>& pose) {
  if (line.size() < 4 || line[0] != '0' || !readStation(line.substr(0, 2), station)) return false;
  std::size_t count = 0;
  for (std::size_t at = 3; at < line.size();) {
    if (line[at] == ' ' || line[at] == '\r' || line[at] == '\t') {
      ++at;
      continue;
    }
    std::size_t end = at + 1;
    while (end < line.size() && std::string_view("0123456789.eE").find(line[end]) != std::string_view::npos) {
      const bool exponent = line[end] == 'e' || line[end] == 'E';
      end += exponent && end + 1 < line.size() && (line[end + 1] == '-' || line[end + 1] == '+') ? 2U : 1U;
    }
    if (count == pose.size() || std::string_view("+-.0123456789").find(line[at]) == std::string_view::npos)
      return false;
    pose[count++] = line.substr(at, end - at);
    at = end;
  }
  return count == pose.size();
}

/// A table of Polhemus' programs has a line a station: columns "sensor" and "sample" number them.
struct SensorColumns {
  std::size_t sensor = 0, sample = 0, time = 0, position = 0, orientation = 0;

  static bool find(std::string_view line, SensorColumns& columns) {
    std::vector<std::string_view> cells;
    splitCells(line, ',', cells);
    unsigned found = 0;
    for (std::size_t c = cells.size(); c-- > 0;) {
      const std::string name = lowerCase(cells[c]);
      const std::pair<std::string_view, std::size_t*> wanted[] = {{"sensor", &columns.sensor},
                                                                  {"sample", &columns.sample},
                                                                  {"timestamp", &columns.time},
                                                                  {"position", &columns.position},
                                                                  {"orientation", &columns.orientation}};
      for (unsigned i = 0; i < 5; ++i) {
        if (i < 3 ? name != wanted[i].first : !name.starts_with(wanted[i].first)) continue;
        *wanted[i].second = c;
        found |= 1U << i;
      }
    }
    return found == 31 && columns.position + 3 <= cells.size() && columns.orientation + 3 <= cells.size();
  }
};

bool readStations(std::string_view text, const std::string& file, StationTable& table) {
  SensorColumns columns;
  std::array<std::string_view, 6> pose;
  std::size_t station = 0, line = 1;
  const std::string_view head = text.substr(0, text.find('\n'));
  const bool named = SensorColumns::find(head, columns);
  if (named) takeLine(text);
  std::vector<std::string_view> cells;
  for (line += named ? 1 : 0; !text.empty(); ++line) {
    const std::string_view row = takeLine(text);
    if (stripped(row).empty()) continue;
    std::string_view sample, time;
    bool read = false;
    if (named) {
      splitCells(row, ',', cells);
      const std::size_t last =
          std::max({columns.sensor, columns.sample, columns.time, columns.position + 2, columns.orientation + 2});
      read = last < cells.size() && readStation(cells[columns.sensor], station);
      for (std::size_t i = 0; read && i < 6; ++i)
        pose[i] = cells[i < 3 ? columns.position + i : columns.orientation + i - 3];
      if (read) sample = cells[columns.sample], time = cells[columns.time];
    } else {
      read = readRecord(row, station, pose);
    }
    if (!read)
      throw Error(ErrorKind::damaged, Where{file, fmt::format("line {}", line)},
                  "no record of a Polhemus tracker: a station and six numbers are expected");
    table.add(station, sample, time, pose);
  }
  return named;
}

bool isStations(std::string_view text) {
  SensorColumns columns;
  std::array<std::string_view, 6> pose;
  std::size_t station = 0;
  const std::string_view line = takeLine(text);
  return readRecord(line, station, pose) || SensorColumns::find(line, columns);
}

/// Kind of a file that is not text, and the way to one; null: it may be text.
const char* foreignKind(std::string_view text) {
  const auto is = [&](const auto& foreign) { return text.starts_with(foreign.first); };
  const auto found = std::find_if(std::begin(foreignFiles), std::end(foreignFiles), is);
  return found == std::end(foreignFiles) ? nullptr : found->second;
}

bool isSequence(std::string_view text) {
  return std::any_of(std::begin(sequenceStarts), std::end(sequenceStarts),
                     [&](std::string_view start) { return text.starts_with(start); });
}

}  // namespace

bool isRewritten(std::string_view text) {
  return foreignKind(text) != nullptr || isDemonstrations(text) || isSequence(text) || isStations(text);
}

std::string_view motionText(std::span<const std::byte> bytes, const std::string& file,
                            const std::optional<std::string>& demonstration, std::string& converted) {
  const std::string_view raw(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (const char* what = foreignKind(raw)) throw Error(ErrorKind::damaged, Where{file}, fmt::format("is {}", what));
  if (isDemonstrations(raw)) return converted = demonstrationTable(bytes, file, demonstration);
  if (isSequence(raw)) return converted = SequenceText(raw).table();
  const std::string_view text = decodedText(bytes, converted);
  if (!isStations(text)) return text;
  StationTable table;
  const bool timed = readStations(text, file, table);
  return converted = table.text(timed);  // `text` may lie in it: all of it was read
}

}  // namespace calot::recorder
