// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/rows.h"

#include <cmath>

namespace calot::recorder {

namespace {

/// Takes every field from the front of the bytes.
struct TakeFields {
  std::span<const std::byte> bytes;
  std::string fault = {};

  template <class T>
  void operator()(const char* /*name*/, const char* /*unit*/, T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      const auto flag = takeValue<std::uint8_t>(bytes);
      if (flag > 1) fault = "has a flag that is neither 0 nor 1";
      value = flag == 1;
    } else if constexpr (std::is_same_v<T, Vec3>) {
      for (int i = 0; i < 3; ++i) value[i] = takeValue<double>(bytes);
    } else if constexpr (std::is_same_v<T, Quat>) {
      const auto wxyz = takeValue<std::array<double, 4>>(bytes);
      value = Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    } else {
      value = takeValue<T>(bytes);
    }
  }
};

template <class Row>
std::string take(std::span<const std::byte> bytes, Row& out) {
  TakeFields fields{bytes};
  visitRow(out, fields);
  return fields.fault;
}

}  // namespace

std::string parseRow(std::span<const std::byte> bytes, Event& out) { return take(bytes, out); }
std::string parseRow(std::span<const std::byte> bytes, KeyframeRow& out) { return take(bytes, out); }
std::string parseRow(std::span<const std::byte> bytes, RawCounts& out) { return take(bytes, out); }

std::string parseRow(std::span<const std::byte> bytes, StatusRow& out) {
  const std::string fault = take(bytes, out);
  if (out.wallNanoseconds < 0) return "was written before 1970";
  const bool known =
      fault.empty() && out.outcome <= Outcome::technicalFailure && out.completed == (out.outcome != Outcome::running);
  return known ? "" : "has an unknown outcome";
}

std::string parseRow(std::span<const std::byte> bytes, RawSample& out) {
  if (std::string fault = take(bytes, out); !fault.empty()) return fault;
  const DeviceSample& s = out.sample;
  if (out.used && !s.valid) return "was used and is not valid";
  if (s.valid && !(s.position.allFinite() && s.orientation.coeffs().allFinite() && std::isfinite(s.gripper)))
    return "is valid and not finite";
  return {};
}

}  // namespace calot::recorder
