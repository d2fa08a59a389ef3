// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"
#include "recorder/sources/column_map.h"
#include "recorder/sources/pose_checks.h"
#include "sim/math/elementary.h"

namespace calot::recorder {
namespace {

constexpr double maxMotion = 1e6;  // s
constexpr double unitLength = 1e-2;
constexpr std::size_t noPlace = static_cast<std::size_t>(-1);

/// Numbers of a hand's wanted columns among all that are wanted.
struct HandPlaces {
  std::size_t position = noPlace, orientation = noPlace, status = noPlace, jaw = noPlace, pedal = noPlace;
};

/// Poses of one hand, row by row.
class HandReader {
 public:
  HandReader(const ColumnMap& map, const HandColumns& columns, HandPlaces places)
      : map_(map), columns_(columns), places_(places) {}

  /// @return false: not measured
  bool read(MotionTable& table, Vec3& position, Quat& orientation) const {
    if (places_.status != noPlace) {
      const std::string_view state = table.text(places_.status);
      const auto is = [&](const std::string& word) { return word == state || lowerCase(word) == lowerCase(state); };
      if (std::none_of(columns_.valid.begin(), columns_.valid.end(), is)) return false;
    }
    std::array<double, 9> values{};
    if (!numbers(table, places_.position, 3, values)) return false;
    position = map_.metres * Vec3(values[0], values[1], values[2]);
    const auto fail = [&](const std::string& fault) { table.fail(fault); };
    checkPosition(position,
                  ": the map's unit of length may be wrong, or a number that marks what was not measured belongs in "
                  "\"missing\" of the map",
                  fail);
    const std::size_t parts = columns_.orientation.size();
    if (parts > 0) {
      if (!numbers(table, places_.orientation, parts, values)) return false;
      orientation = parts == 4 ? unit(values, fail) : parts == 3 ? rotated(values) : fromMatrix(values, fail);
    }
    if (map_.leftHanded) {
      position.z() = -position.z();
      orientation = Quat(orientation.w(), -orientation.x(), -orientation.y(), orientation.z());
    }
    orientation = orientation * columns_.axis;
    return true;
  }

  /// Further columns of a row, which may be missing alone.
  void readFurther(MotionTable& table, TrackedHand& hand) const {
    std::array<double, 9> value{};
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    if (places_.jaw != noPlace) hand.jaw.push_back(numbers(table, places_.jaw, 1, value) ? value[0] : none);
    if (places_.pedal != noPlace) hand.pedal.push_back(numbers(table, places_.pedal, 1, value) && value[0] != 0.0);
  }

 private:
  bool numbers(MotionTable& table, std::size_t first, std::size_t count, std::array<double, 9>& values) const {
    bool measured = true;
    for (std::size_t i = 0; i < count; ++i) {
      if (table.plainNumber(first + i, values[i])) continue;
      std::string fault;
      const MotionTable::Cell cell = table.number(first + i, values[i], fault);
      if (cell == MotionTable::Cell::fault) {
        table.fail(fmt::format("column \"{}\": {}", shown(table.name(first + i)), fault));
      }
      measured = measured && cell == MotionTable::Cell::number;
    }
    return measured;
  }

  static Quat unit(const std::array<double, 9>& q, const auto& fail) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(std::abs(length - 1.0) <= unitLength))
      fail(fmt::format("a quaternion of length {:.3g}; 1 is expected", length));
    return {q[0] / length, q[1] / length, q[2] / length, q[3] / length};
  }

  static Quat fromMatrix(const std::array<double, 9>& values, const auto& fail) {
    using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
    return checkedRotation(Eigen::Map<const RowMajor>(values.data()), fail);
  }

  [[nodiscard]] Quat rotated(const std::array<double, 9>& angles) const {
    constexpr double degree = 0.017453292519943295769;
    Quat q = Quat::Identity();
    for (std::size_t i = 0; i < 3; ++i) {
      const double half = 0.5 * angles[i] * (columns_.radians ? 1.0 : degree);
      double axis[3] = {};
      axis[columns_.sequence[i]] = sine(half);
      q = q * Quat(cosine(half), axis[0], axis[1], axis[2]);
    }
    return q;
  }

  const ColumnMap& map_;
  const HandColumns& columns_;
  HandPlaces places_;
};

}  // namespace

TrackedMotion readCsvMotion(const std::filesystem::path& file, const ColumnMap& map) {
  const std::string name = file.filename().string();
  return parseCsvMotion(readFileBytes(file, name, maxMotionBytes), name, map);
}

TrackedMotion parseCsvMotion(std::span<const std::byte> bytes, const std::string& file, const ColumnMap& map) {
  std::vector<std::string> wanted;
  const auto want = [&](const auto& names) {
    wanted.insert(wanted.end(), names.begin(), names.end());
    return wanted.size() - names.size();
  };
  const bool timed = map.rate == 0.0, nanoseconds = !map.nanoseconds.empty();
  if (timed) wanted.push_back(map.time);
  if (nanoseconds) wanted.push_back(map.nanoseconds);
  TrackedMotion motion;
  std::vector<std::pair<std::size_t, HandReader>> readers;
  for (std::size_t h = 0; h < map.hand.size(); ++h) {
    if (!map.hand[h]) continue;
    const HandColumns& columns = *map.hand[h];
    HandPlaces places{want(columns.position), want(columns.orientation)};
    for (const auto& [name, place] :
         {std::pair(&columns.status, &places.status), {&columns.jaw, &places.jaw}, {&columns.pedal, &places.pedal}}) {
      if (!name->empty()) *place = want(std::array{*name});
    }
    readers.emplace_back(h, HandReader(map, columns, places));
    motion.hand[h].present = true;
    motion.hand[h].oriented = !columns.orientation.empty();
  }
  MotionTable table(bytes, file, map.style, wanted);
  motion.file = file;
  motion.device = map.device;
  motion.frame = map.frame;
  motion.rate = map.rate;
  if (!map.source.empty()) motion.notes.push_back("read as " + map.source);

  const std::size_t expected = table.rowsExpected();
  motion.time.reserve(expected);
  for (TrackedHand& hand : motion.hand) {
    hand.position.reserve(hand.present ? expected : 0);
    hand.orientation.reserve(hand.oriented ? expected : 0);
  }
  MotionClock clock(map.clock);
  std::size_t dropped = 0;
  std::array<std::size_t, handCount> unmeasured{};
  std::string fault;
  while (table.next()) {
    double time = static_cast<double>(motion.time.size()) / map.rate;
    if (timed) {
      time = clock.seconds(table.text(0), nanoseconds ? table.text(1) : std::string_view(), fault);
      if (!fault.empty()) table.fail(fmt::format("column \"{}\": {}", shown(map.time), fault));
      if (!motion.time.empty() && !(time > motion.time.back())) {
        if (!map.dropsDisorder) {
          const double later = time - motion.time.back();
          const bool putBack = std::abs(later + 3600.0) < 60.0;
          table.fail(
              fmt::format("its time is not after the row before ({:g} s later{}); \"disorder\": \"drop\" in "
                          "the map leaves such rows out",
                          later, putBack ? ", as clocks put back in autumn: export UTC instead" : ""));
        }
        ++dropped;
        continue;
      }
    }
    if (!(time <= maxMotion))
      table.fail(fmt::format("more than {:g} s after the first row: the map's unit of time may be wrong", maxMotion));
    motion.time.push_back(time);
    for (const auto& [h, reader] : readers) {
      TrackedHand& hand = motion.hand[h];
      Vec3 position = Vec3::Zero();
      Quat orientation = Quat::Identity();
      const bool measured = reader.read(table, position, orientation);
      if (!measured) {
        position = Vec3::Constant(std::numeric_limits<double>::quiet_NaN());
        orientation = Quat::Identity();
        ++unmeasured[h];
      }
      hand.position.push_back(position);
      if (hand.oriented) hand.orientation.push_back(orientation);
      hand.missing.push_back(!measured);
      reader.readFurther(table, hand);
    }
  }
  motion.sha256 = sha256Hex(bytes);
  const std::size_t rows = motion.time.size();
  if (rows < 2)
    throw Error(ErrorKind::damaged, Where{file}, fmt::format("{}; a motion has at least 2", counted(rows, "row")));
  if (dropped > 0) motion.notes.push_back(counted(dropped, "row") + " left out, not later than the row before");
  for (std::size_t h = 0; h < map.hand.size(); ++h) {
    if (!map.hand[h] || unmeasured[h] == 0) continue;
    if (rows - unmeasured[h] < 2)
      throw Error(ErrorKind::damaged, Where{file},
                  fmt::format("{} hand: {} of {} rows measured; a motion has at least 2", handNames[h],
                              rows - unmeasured[h], rows));
    motion.notes.push_back(
        fmt::format("{} hand: {} without a measurement", handNames[h], counted(unmeasured[h], "row")));
  }
  if (!map.verified) {
    checkUnits(motion);
    markInvalidSamples(motion);
  }
  return motion;
}

}  // namespace calot::recorder
