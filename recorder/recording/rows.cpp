// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/rows.h"

#include <cmath>

namespace calot::recorder {

void appendEvent(const Event& event, std::vector<std::byte>& out) {
  appendValue(out, event.step);
  appendValue(out, event.kind);
  appendValue(out, event.hand);
  appendValue(out, event.subject);
  appendBytes(out, event.position.data(), 3 * sizeof(double));
  appendValue(out, event.value);
}

Event parseEvent(std::span<const std::byte> row) {
  Event e;
  e.step = takeValue<std::uint64_t>(row);
  e.kind = static_cast<EventKind>(takeValue<std::uint16_t>(row));
  e.hand = takeValue<std::uint8_t>(row);
  e.subject = takeValue<std::uint16_t>(row);
  for (int i = 0; i < 3; ++i) e.position[i] = takeValue<double>(row);
  e.value = takeValue<double>(row);
  return e;
}

void appendKeyframeRow(const KeyframeRow& row, std::vector<std::byte>& out) {
  appendValue(out, row.step);
  appendValue(out, row.offset);
  appendValue(out, row.stateBytes);
  appendValue(out, row.hapticsBytes);
}

KeyframeRow parseKeyframeRow(std::span<const std::byte> row) {
  KeyframeRow k;
  k.step = takeValue<std::uint64_t>(row);
  k.offset = takeValue<std::uint64_t>(row);
  k.stateBytes = takeValue<std::uint64_t>(row);
  k.hapticsBytes = takeValue<std::uint64_t>(row);
  return k;
}

void appendStatus(const StatusRow& row, std::vector<std::byte>& out) {
  appendValue(out, row.ticks);
  appendValue(out, row.steps);
  appendValue(out, row.events);
  appendValue(out, row.keyframes);
  appendValue(out, row.keyframeWords);
  appendValue(out, static_cast<std::uint8_t>(row.completed ? 1 : 0));
  appendValue(out, row.outcome);
  appendValue(out, row.wallNanoseconds);
  appendBytes(out, row.chain.data(), row.chain.size());
}

std::string parseStatus(std::span<const std::byte> bytes, StatusRow& row) {
  row.ticks = takeValue<std::uint64_t>(bytes);
  row.steps = takeValue<std::uint64_t>(bytes);
  row.events = takeValue<std::uint64_t>(bytes);
  row.keyframes = takeValue<std::uint64_t>(bytes);
  row.keyframeWords = takeValue<std::uint64_t>(bytes);
  const auto completed = takeValue<std::uint8_t>(bytes);
  const auto outcome = takeValue<std::uint8_t>(bytes);
  row.wallNanoseconds = takeValue<std::int64_t>(bytes);
  std::memcpy(row.chain.data(), bytes.data(), row.chain.size());
  row.completed = completed == 1;
  row.outcome = static_cast<Outcome>(outcome);
  if (row.wallNanoseconds < 0) return "was written before 1970";
  const bool known = completed <= 1 && outcome <= static_cast<std::uint8_t>(Outcome::technicalFailure) &&
                     (completed == 1) == (row.outcome != Outcome::running);
  return known ? "" : "has an unknown outcome";
}

void appendRawCounts(const StatusRow& row, std::vector<std::byte>& out) {
  for (const std::uint64_t count : row.rawSamples) appendValue(out, count);
  for (const std::uint64_t count : row.rawDropped) appendValue(out, count);
}

void parseRawCounts(std::span<const std::byte> bytes, StatusRow& row) {
  for (std::uint64_t& count : row.rawSamples) count = takeValue<std::uint64_t>(bytes);
  for (std::uint64_t& count : row.rawDropped) count = takeValue<std::uint64_t>(bytes);
}

void appendRawSample(const RawSample& raw, std::vector<std::byte>& out) {
  const DeviceSample& s = raw.sample;
  appendValue(out, s.deviceTime);
  appendValue(out, s.hostTime);
  appendValue(out, s.sequence);
  appendValue(out, raw.tick);
  appendBytes(out, s.position.data(), 3 * sizeof(double));
  for (const double v : {s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z()})
    appendValue(out, v);
  appendValue(out, s.gripper);
  appendValue(out, s.buttons);
  appendValue(out, static_cast<std::uint8_t>(s.valid ? 1 : 0));
  appendValue(out, static_cast<std::uint8_t>(raw.used ? 1 : 0));
}

std::string parseRawSample(std::span<const std::byte> row, Hand hand, RawSample& out) {
  DeviceSample& s = out.sample;
  s.hand = hand;
  s.deviceTime = takeValue<std::int64_t>(row);
  s.hostTime = takeValue<std::int64_t>(row);
  s.sequence = takeValue<std::uint64_t>(row);
  out.tick = takeValue<std::uint64_t>(row);
  for (int i = 0; i < 3; ++i) s.position[i] = takeValue<double>(row);
  const auto w = takeValue<double>(row);
  const auto x = takeValue<double>(row);
  const auto y = takeValue<double>(row);
  const auto z = takeValue<double>(row);
  s.orientation = Quat(w, x, y, z);
  s.gripper = takeValue<double>(row);
  s.buttons = takeValue<std::uint8_t>(row);
  const auto valid = takeValue<std::uint8_t>(row);
  const auto used = takeValue<std::uint8_t>(row);
  s.valid = valid == 1;
  out.used = used == 1;
  if (valid > 1 || used > 1) return "has a flag that is neither 0 nor 1";
  if (out.used && !s.valid) return "was used and is not valid";
  if (s.valid && !(s.position.allFinite() && s.orientation.coeffs().allFinite() && std::isfinite(s.gripper)))
    return "is valid and not finite";
  return {};
}

}  // namespace calot::recorder
