// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/tracked_motion.h"

#include <fmt/format.h>
#include <charconv>
#include <cmath>
#include <string_view>

#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

constexpr std::size_t columns = 76;
constexpr std::size_t groupColumns = 19;
constexpr std::array<std::size_t, handCount> slaveColumn{2 * groupColumns, 3 * groupColumns};
constexpr std::size_t maxBytes = std::size_t{1} << 30U;
constexpr std::size_t maxRows = 1000000;

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

class LineReader {
 public:
  LineReader(const std::string& file, std::size_t line) : file_(file), line_(line) {}

  [[noreturn]] void fail(const std::string& fault) const {
    throw Error(ErrorKind::damaged, Where{file_, fmt::format("line {}", line_)}, fault);
  }

  void numbers(std::string_view text, std::array<double, columns>& out) const {
    std::size_t count = 0;
    for (std::size_t at = 0; at < text.size();) {
      if (isBlank(text[at])) {
        ++at;
        continue;
      }
      std::size_t end = at;
      while (end < text.size() && !isBlank(text[end])) ++end;
      const std::string_view word = text.substr(at, end - at);
      if (count < columns) out[count] = number(word, count + 1);
      ++count;
      at = end;
    }
    if (count != columns) fail(fmt::format("{} columns; {} are wanted", count, columns));
  }

  [[nodiscard]] KinematicsPose pose(const std::array<double, columns>& v, std::size_t first) const {
    KinematicsPose pose;
    pose.position = Vec3(v[first], v[first + 1], v[first + 2]);
    if (!(pose.position.cwiseAbs().maxCoeff() <= maxPosition)) {
      fail(fmt::format("columns {} to {}: a position farther than {} m; positions are in metres", first + 1, first + 3,
                       maxPosition));
    }
    Mat3 rotation;
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) rotation(r, c) = v[first + 3 + static_cast<std::size_t>(3 * r + c)];
    }
    const double off = rotationDefect(rotation);  // the format's own rounding is below 1e-4
    if (!(off <= rotationTolerance)) {
      fail(fmt::format("columns {} to {}: no rotation matrix (off by {:.2g}; {:.2g} is allowed)", first + 4, first + 12,
                       off, rotationTolerance));
    }
    pose.orientation = quaternionOf(rotation);
    pose.gripper = v[first + 18];
    return pose;
  }

 private:
  // Locale plays no part; "nan", "inf", hexadecimal and half-read words are refused.
  [[nodiscard]] double number(std::string_view word, std::size_t column) const {
    double value = 0.0;
    const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (fault != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
      std::string shown;
      for (const char c : word.substr(0, 20)) shown += c > 0x20 && c < 0x7f ? c : '?';
      fail(fmt::format("column {}: \"{}\" is no finite number", column, shown));
    }
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
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.empty()) throw Error(ErrorKind::damaged, Where{file}, "the file is empty");
  KinematicsMotion motion;
  motion.file = file;
  std::array<double, columns> values{};
  std::size_t line = 0, blank = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view row = text.substr(at, end - at);
    at = end + 1;
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

}  // namespace calot::recorder
