// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/tracked_motion.h"
#include "recorder/base/record_json.h"

#include <fmt/format.h>
#include <charconv>
#include <cmath>
#include <string_view>

#include "recorder/base/csv.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

constexpr std::size_t columns = 76;
constexpr std::size_t groupColumns = 19;
constexpr std::array<std::size_t, handCount> slaveColumn{2 * groupColumns, 3 * groupColumns};
constexpr std::size_t maxBytes = std::size_t{1} << 30U;
constexpr std::size_t maxRows = 1000000;

/// @param fail throws with this fault @param hint on what may be wrong
void checkPosition(const Vec3& position, const char* hint, const auto& fail) {
  if (!(position.cwiseAbs().maxCoeff() <= maxPosition))
    fail(fmt::format("a position farther than {} m{}", maxPosition, hint));
}

Quat checkedRotation(const Mat3& matrix, const auto& fail) {
  const double off = rotationDefect(matrix);  // rounding in the format of kinematics is below 1e-4
  if (!(off <= rotationTolerance))
    fail(fmt::format("no rotation matrix (off by {:.2g}; {:.2g} is allowed)", off, rotationTolerance));
  return quaternionOf(matrix);
}

class LineReader {
 public:
  LineReader(const std::string& file, std::size_t line) : file_(file), line_(line) {}

  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(ErrorKind::damaged, Where{file_, fmt::format("line {}", line_)}, fault);
  }

  void numbers(std::string_view text, std::array<double, columns>& out) const {
    Words words(text);
    std::size_t count = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++count) {
      if (count < columns) out[count] = number(word, count + 1);
    }
    if (count != columns) fail(fmt::format("{} columns; {} are expected", count, columns));
  }

  [[nodiscard]] KinematicsPose pose(const std::array<double, columns>& v, std::size_t first) const {
    KinematicsPose pose;
    pose.position = Vec3(v[first], v[first + 1], v[first + 2]);
    const auto failAt = [&](std::size_t from, std::size_t to) {
      return [=, this](const std::string& fault) { fail(fmt::format("columns {} to {}: {}", from, to, fault)); };
    };
    checkPosition(pose.position, "; positions are in metres", failAt(first + 1, first + 3));
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    pose.orientation = checkedRotation(Eigen::Map<const RowMajor>(v.data() + first + 3), failAt(first + 4, first + 12));
    pose.gripper = v[first + 18];
    return pose;
  }

 private:
  // Locale plays no part; "nan", "inf", hexadecimal and half-read words are refused.
  [[nodiscard]] double number(std::string_view word, std::size_t column) const {
    double value = 0.0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
      fail(fmt::format("column {}: \"{}\" is not a finite number", column, shown(word.substr(0, 20))));
    return value;
  }

  const std::string& file_;
  std::size_t line_;
};

}  // namespace

KinematicsMotion readKinematics(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseKinematics(readFileBytes(file, name, maxBytes), name);
}

KinematicsMotion parseKinematics(std::span<const std::byte> bytes, const std::string& file) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.empty()) throw Error(ErrorKind::damaged, Where{file}, "the file is empty");
  KinematicsMotion motion;
  motion.file = file;
  std::array<double, columns> values{};
  std::size_t line = 0, blank = 0;
  while (!text.empty()) {
    const std::string_view row = takeLine(text);
    ++line;
    const LineReader reader(file, line);
    if (row.find_first_not_of(" \t\r") == std::string_view::npos) {
      if (blank == 0) blank = line;
      continue;
    }
    // Empty lines may end a file; between rows they would hide rows that are missing.
    if (blank != 0) LineReader(file, blank).fail("an empty line between rows");
    if (motion.rows.size() == maxRows) reader.fail(fmt::format("more than {} rows", maxRows));
    reader.numbers(row, values);
    std::array<KinematicsPose, handCount> poses;
    for (std::size_t h = 0; h < handCount; ++h) poses[h] = reader.pose(values, slaveColumn[h]);
    motion.rows.push_back(poses);
  }
  if (motion.rows.size() < 2) {
    throw Error(ErrorKind::damaged, Where{file}, fmt::format("{} row; a motion has at least 2", motion.rows.size()));
  }
  motion.sha256 = sha256Hex(bytes);
  return motion;
}

TrackedMotion trackedMotion(const KinematicsMotion& motion) {
  TrackedMotion tracked;
  tracked.file = motion.file;
  tracked.sha256 = motion.sha256;
  tracked.rate = kinematicsRowsPerSecond;
  for (std::size_t h = 0; h < tracked.hand.size(); ++h) {
    TrackedHand& hand = tracked.hand[h];
    hand.present = hand.oriented = true;
    for (const auto& row : motion.rows) {
      hand.position.push_back(row[h].position);
      hand.orientation.push_back(row[h].orientation);
    }
  }
  for (std::size_t i = 0; i < motion.rows.size(); ++i)
    tracked.time.push_back(static_cast<double>(i) / kinematicsRowsPerSecond);
  return tracked;
}

namespace {

constexpr std::size_t maxMapBytes = 1U << 20U;
constexpr std::size_t maxMotionBytes = std::size_t{1} << 30U;
constexpr double maxMotion = 1e6;  // s
constexpr double unitLength = 1e-2;
constexpr double root = 0.70710678118654752440;  // of 1/2

constexpr TextRule columnName{200}, word{60, "^[!-~]+$", "a word without blanks is expected"};

const FieldWords lengths{{"m", 0}, {"cm", 1}, {"mm", 2}}, times{{"s", 0}, {"ms", 1}, {"us", 2}, {"ns", 3}},
    axes{{"z", 0}, {"-z", 1}, {"x", 2}, {"-x", 3}, {"y", 4}, {"-y", 5}};

std::vector<Field> timeFields() {
  using S = ColumnMap;
  return {
      object("time", "Column of times, read to the picosecond; each is after the one before"),
      {"column", at<S, &S::time>, columnName, "Name of the column"},
      {"unit", unstored<bool>, times, "Unit of the times"},
  };
}

}  // namespace

std::vector<Field> HandColumns::fields() {
  using S = HandColumns;
  return {
      object("hand", "Columns of one hand's instrument"),
      Field("position", at<S, &S::position>, columnName, "x, y, z of the tip").items(3, 3),
      optional("quaternion", at<S, &S::orientation>, columnName,
               "w, x, y, z of the orientation of the instrument in the frame")
          .items(4, 4),
      optional("matrix", at<S, &S::orientation>, columnName,
               "The same as a rotation matrix, row by row; either this or quaternion, or neither")
          .items(9, 9),
      optional("axis", unstored<bool>, axes, "The instrument's axis towards its tip, in its own frame; z if absent"),
  };
}

std::vector<Field> ColumnMap::fields() {
  using S = ColumnMap;
  return {
      object("",
             "Columns of a CSV file of instrument motion, their units and their frame. "
             "The file's first line names its columns"),
      fileFormat("calot-columns"),
      fileFormatVersion(),
      optional("device", at<S, &S::device>, word,
               "Class of tracker, a word without blanks: attempts of different classes are not compared"),
      {"frame", at<S, &S::frame>, word,
       "Frame of positions and orientations, a word without blanks: world, robot-base, camera; attempts of different "
       "frames are not compared"},
      {"length", unstored<bool>, lengths, "Unit of the positions"},
      optional("delimiter", at<S, &S::delimiter>, FieldWords{{",", ','}, {";", ';'}, {"tab", '\t'}},
               "Character between cells"),
      optional("rate", at<S, &S::rate>, "Hz", within(1, 100000),
               "Rate of rows, where there is no column of times. Either this or time"),
      optional("time", keyGroup<S, timeFields>, "Column of times"),
      optional("left", at<S, &S::hand, 0>, "Left hand"),
      optional("right", at<S, &S::hand, 1>, "Right hand; at least one hand is expected"),
  };
}

namespace {

/// Motions of one length are equal in ranks whenever they began, which a difference of two times in binary is not.
double toPicosecond(double seconds) { return std::round(seconds * 1e12) / 1e12; }

void checkHand(const JsonPlace& place, HandColumns& hand) {
  if (place.has("quaternion") && place.has("matrix"))
    place.fail("has a quaternion and a matrix; one of them is expected");
  if (!place.has("axis")) return;
  if (hand.orientation.empty()) place.at("axis").fail("an axis without an orientation");
  const Quat rotations[] = {Quat::Identity(),
                            Quat(0.0, 1.0, 0.0, 0.0),
                            Quat(root, 0.0, root, 0.0),
                            Quat(root, 0.0, -root, 0.0),
                            Quat(root, -root, 0.0, 0.0),
                            Quat(root, root, 0.0, 0.0)};
  hand.axis = rotations[place.at("axis").word(axes)];
}

class RowReader {
 public:
  RowReader(const std::string& file, const CsvNumbers& numbers) : file_(file), numbers_(numbers) {}

  [[noreturn]] void fail(std::size_t row, const std::string& fault) const {
    throw Error(ErrorKind::damaged, Where{file_, fmt::format("line {}", numbers_.line[row])}, fault);
  }
  [[nodiscard]] double at(std::size_t column, std::size_t row) const { return numbers_.column[column][row]; }

  [[nodiscard]] Vec3 position(std::size_t first, std::size_t row, double metres) const {
    const Vec3 p(metres * at(first, row), metres * at(first + 1, row), metres * at(first + 2, row));
    checkPosition(p, ": the map's unit of length may be wrong", [&](const std::string& fault) { fail(row, fault); });
    return p;
  }

  [[nodiscard]] Quat orientation(std::size_t first, std::size_t count, std::size_t row) const {
    if (count == 4) {
      const Quat q(at(first, row), at(first + 1, row), at(first + 2, row), at(first + 3, row));
      const double length = std::sqrt(q.w() * q.w() + q.x() * q.x() + q.y() * q.y() + q.z() * q.z());
      if (!(std::abs(length - 1.0) <= unitLength))
        fail(row, fmt::format("a quaternion of length {:.3g}; 1 is expected", length));
      return {q.w() / length, q.x() / length, q.y() / length, q.z() / length};
    }
    Mat3 rotation;
    for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = at(first + static_cast<std::size_t>(i), row);
    return checkedRotation(rotation, [&](const std::string& fault) { fail(row, fault); });
  }

 private:
  const std::string& file_;
  const CsvNumbers& numbers_;
};

}  // namespace

ColumnMap readColumnMap(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseColumnMap(readFileBytes(file, name, maxMapBytes), name);
}

ColumnMap parseColumnMap(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json json = parseStrictJson(bytes, file);
  const JsonPlace place(json, file);
  constexpr double metres[] = {1.0, 0.01, 0.001}, seconds[] = {1.0, 1e-3, 1e-6, 1e-9};
  ColumnMap map;
  readRecord(place, map);
  map.metres = metres[place.at("length").word(lengths)];
  if (place.has("rate") == place.has("time"))
    place.fail("either \"rate\" (rows a second) or \"time\" (a column) is expected");
  if (place.has("time")) map.seconds = seconds[place.at("time").at("unit").word(times)];
  for (std::size_t h = 0; h < map.hand.size(); ++h) {
    if (map.hand[h]) checkHand(place.at(handNames[h]), *map.hand[h]);
  }
  if (!map.hand[0] && !map.hand[1]) place.fail("neither \"left\" nor \"right\": a hand is expected");
  return map;
}

TrackedMotion readCsvMotion(const std::filesystem::path& file, const ColumnMap& map) {
  const std::string name = file.filename().string();
  return parseCsvMotion(readFileBytes(file, name, maxMotionBytes), name, map);
}

TrackedMotion parseCsvMotion(std::span<const std::byte> bytes, const std::string& file, const ColumnMap& map) {
  std::vector<std::string> wanted;
  std::array<std::size_t, handCount> position{}, orientation{};
  if (map.rate == 0.0) wanted.push_back(map.time);
  for (std::size_t h = 0; h < map.hand.size(); ++h) {
    if (!map.hand[h]) continue;
    position[h] = wanted.size();
    wanted.insert(wanted.end(), map.hand[h]->position.begin(), map.hand[h]->position.end());
    orientation[h] = wanted.size();
    wanted.insert(wanted.end(), map.hand[h]->orientation.begin(), map.hand[h]->orientation.end());
  }
  const CsvNumbers numbers = readCsvNumbers(bytes, file, map.delimiter, wanted);
  const std::size_t rows = numbers.line.size();
  if (rows < 2) throw Error(ErrorKind::damaged, Where{file}, "1 row; a motion has at least 2");
  const RowReader reader(file, numbers);

  TrackedMotion motion;
  motion.file = file;
  motion.sha256 = sha256Hex(bytes);
  motion.device = map.device;
  motion.frame = map.frame;
  motion.rate = map.rate;
  for (std::size_t i = 0; i < rows; ++i) {
    const double time = map.rate > 0.0 ? static_cast<double>(i) / map.rate
                                       : toPicosecond((reader.at(0, i) - reader.at(0, 0)) * map.seconds);
    if (i > 0 && !(time > motion.time.back())) reader.fail(i, "its time is not after the row before");
    if (!(time <= maxMotion))
      reader.fail(i,
                  fmt::format("more than {:g} s after the first row: the map's unit of time may be wrong", maxMotion));
    motion.time.push_back(time);
  }
  for (std::size_t h = 0; h < map.hand.size(); ++h) {
    if (!map.hand[h]) continue;
    TrackedHand& hand = motion.hand[h];
    const std::size_t parts = map.hand[h]->orientation.size();
    hand.present = true;
    hand.oriented = parts > 0;
    for (std::size_t i = 0; i < rows; ++i) {
      hand.position.push_back(reader.position(position[h], i, map.metres));
      hand.orientation.push_back(hand.oriented ? reader.orientation(orientation[h], parts, i) * map.hand[h]->axis
                                               : Quat::Identity());
    }
  }
  return motion;
}

}  // namespace calot::recorder
