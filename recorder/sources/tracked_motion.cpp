// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/tracked_motion.h"

#include <fmt/format.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"
#include "recorder/sources/motion_text.h"
#include "recorder/sources/pose_checks.h"

namespace calot::recorder {
namespace {

constexpr std::size_t columns = 76;
constexpr std::size_t groupColumns = 19;
constexpr std::array<std::size_t, handCount> slaveColumn{2 * groupColumns, 3 * groupColumns};
constexpr std::size_t maxBytes = std::size_t{1} << 30U;
constexpr std::size_t maxRows = 1000000;

/// With blanks for commas and semicolons, where these are as many as stand between the columns.
std::string blankSeparated(std::string_view line) {
  constexpr auto separates = [](char c) { return c == ',' || c == ';'; };
  std::string out(line);
  if (std::count_if(out.begin(), out.end(), separates) + 1 >= static_cast<std::ptrdiff_t>(columns))
    std::replace_if(out.begin(), out.end(), separates, ' ');
  return out;
}

class LineReader {
 public:
  LineReader(const std::string& file, std::size_t line) : file_(file), line_(line) {}

  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(ErrorKind::damaged, Where{file_, fmt::format("line {}", line_)}, fault);
  }

  void numbers(std::string_view text, std::array<double, columns>& out) const {
    const std::string separated = blankSeparated(text);
    Words words(separated);
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

bool isKinematicsFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string begin(std::size_t{1} << 16U, '\0');  // a line may be the whole file
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(in.gcount()));
  std::string_view rest(begin);
  const std::string_view line = takeLine(rest);
  const std::string separated = blankSeparated(line);
  Words words(separated);
  std::size_t count = 0, numbers = 0;
  for (std::string_view word = words.next(); !word.empty(); word = words.next(), ++count)
    if (word.find_first_of("0123456789") <= 2) ++numbers;  // behind a sign and a point
  if (count == columns && numbers == columns) return true;
  // Files without separators are described by the reader's own faults.
  return file.extension() != ".csv" && line.find_first_of(",;\t") == std::string::npos && !isRewritten(line);
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
      hand.jaw.push_back(row[h].gripper);
    }
  }
  for (std::size_t i = 0; i < motion.rows.size(); ++i)
    tracked.time.push_back(static_cast<double>(i) / kinematicsRowsPerSecond);
  markInvalidSamples(tracked);
  return tracked;
}

}  // namespace calot::recorder
