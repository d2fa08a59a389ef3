// SPDX-License-Identifier: GPL-3.0-or-later
// Times of rows as files write them: numbers of a unit, dates, times of day. Whole numbers are subtracted before they
// become doubles, so that motions of one length are equal whenever they began.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace calot::recorder {

enum class ClockUnit : std::uint8_t { s, ms, us, ns, frame, iso, timeOfDay };

struct ClockFormat {
  ClockUnit unit = ClockUnit::s;
  double rate = 0.0;   ///< frames a second (Hz), of ClockUnit::frame
  std::string zone;    ///< of dates that state none: "Z", "+02:00"; or empty
  double wraps = 0.0;  ///< units after which a counter begins again; 0: never
};

class MotionClock {
 public:
  explicit MotionClock(const ClockFormat& format) : format_(format) {}

  /// Seconds since the first row, to the picosecond. @param nanoseconds text of a further column, or empty
  /// @param[out] fault "\"x\" is not a number", or left as it is
  double seconds(std::string_view text, std::string_view nanoseconds, std::string& fault);

 private:
  struct Time {
    std::int64_t whole = 0;  ///< units
    double part = 0.0;       ///< further, in [0, 1)
  };
  static Time number(std::string_view text, std::string& fault);
  [[nodiscard]] Time date(std::string_view text, std::string& fault) const;
  static Time timeOfDay(std::string_view text, std::string& fault);

  const ClockFormat& format_;
  bool begun_ = false;
  Time first_;
  double last_ = 0.0, wrapped_ = 0.0;
};

}  // namespace calot::recorder
