// SPDX-License-Identifier: GPL-3.0-or-later
// Reading the values of one row of every column. Internal to the recorder.
#pragma once

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <fmt/format.h>

#include "recorder/recording/layout.h"
#include "sim/instruments/instruments.h"

namespace calot::recorder {

/// Reads every visited value from one row of its column, and finds the first that no writer makes. `place(column)` is
/// where that column's row lies.
template <class Place>
struct RowVisitor {
  const Layout& layout;
  Place place;  ///< where the row of a column lies, by its number
  std::size_t index = 0;
  bool input = false;  ///< samples must be finite; results too, but where the simulation ran away (unfinite)
  std::string fault;
  std::string unfinite = {};  ///< first result that is no finite number

  template <class T>
  void operator()(const char*, const char*, const char*, T& value) {
    std::memcpy(&value, at(), sizeof value);
    check(value);
    ++index;
  }
  void operator()(const char*, const char*, const char*, bool& value) {
    const auto byte = std::to_integer<unsigned>(*at());
    if (byte > 1) fail("is neither 0 nor 1");
    value = byte != 0;
    ++index;
  }
  void operator()(const char*, const char*, const char*, InstrumentKind& value) {
    const auto number = std::to_integer<unsigned>(*at());
    if (!isInstrumentNumber(number)) fail("is no known instrument");
    value = static_cast<InstrumentKind>(number);
    ++index;
  }
  void operator()(const char*, const char*, const char*, Cautery& value) {
    choice(value, Cautery::onTissue, "is no known state of the cautery");
  }
  void operator()(const char*, const char*, const char*, Phase& value) {
    choice(value, Phase::done, "is no known phase");
  }
  void operator()(const char*, const char*, const char*, Vec3& v) {
    std::memcpy(v.data(), at(), 3 * sizeof(double));
    if (!v.allFinite()) failUnfinite();
    ++index;
  }
  void operator()(const char*, const char*, const char*, Quat& q) {
    std::array<double, 4> wxyz{};
    std::memcpy(wxyz.data(), at(), sizeof wxyz);
    q = Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    const double norm = std::sqrt(wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]);
    if (input && !(std::abs(norm - 1.0) <= 1e-3)) fail("is not a unit quaternion within 1e-3");
    if (!std::isfinite(norm)) failUnfinite();
    ++index;
  }
  template <class T>
  void outside(const char*, const char*, const char*, T& value) {
    std::memcpy(&value, at(), sizeof value);
    if (!std::isfinite(value)) fail("is not finite");
    if (value < T{}) fail("is negative");
    ++index;
  }
  template <class T>
  void list(const char*, const char*, const char*, std::vector<T>& values, std::size_t width) {
    values.resize(width);
    if (width > 0) std::memcpy(values.data(), at(), width * sizeof(T));
    for (const T& v : values) check(v);
    ++index;
  }
  template <class Part, class T>
  void each(const char*, const char*, const char*, std::vector<Part>& parts, T Part::*member) {
    parts.resize(layout.countOf(parts));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::byte* value = at() + i * sizeof(T);
      if constexpr (std::is_same_v<T, bool>) {
        const auto byte = std::to_integer<unsigned>(*value);
        if (byte > 1) fail("is neither 0 nor 1");
        parts[i].*member = byte != 0;
      } else {
        std::memcpy(&(parts[i].*member), value, sizeof(T));
        check(parts[i].*member);
      }
    }
    ++index;
  }

 private:
  [[nodiscard]] const std::byte* at() const { return place(index); }
  /// A number from 0 to that of the last name.
  template <class Choice>
  void choice(Choice& value, Choice last, const char* why) {
    const auto code = std::to_integer<unsigned>(*at());
    if (code > static_cast<unsigned>(last)) fail(why);
    value = static_cast<Choice>(code);
    ++index;
  }
  template <class T>
  void check(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) failUnfinite();
    }
  }
  void failUnfinite() {
    std::string& whose = input ? fault : unfinite;
    if (whose.empty()) whose = fmt::format("{}[{{row}}] is not finite", layout.columns[index].path);
  }
  void fail(const char* why) {
    if (fault.empty()) fault = fmt::format("{}[{{row}}] {}", layout.columns[index].path, why);
  }
};

}  // namespace calot::recorder
