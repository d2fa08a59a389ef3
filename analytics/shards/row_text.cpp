// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/shards/row_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace calot::analytics {
namespace {

constexpr const char* hexMark = "_hex";

bool isPrintableUtf8(const std::string& text) {
  if (std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; })) return false;
  try {
    static_cast<void>(nlohmann::json(text).dump());
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

bool decodeHex(const std::string& text, std::span<std::byte> out) {
  if (text.size() != 2 * out.size()) return false;
  for (std::size_t i = 0; i < out.size(); ++i) {
    unsigned value = 0;
    const char* begin = text.data() + 2 * i;
    const auto [end, error] = std::from_chars(begin, begin + 2, value, 16);
    if (error != std::errc() || end != begin + 2) return false;
    out[i] = static_cast<std::byte>(value);
  }
  return true;
}

}  // namespace

std::string hexOf(std::span<const std::byte> bytes) {
  std::string hex;
  for (const std::byte b : bytes) hex += fmt::format("{:02x}", static_cast<unsigned>(b));
  return hex;
}

void putText(nlohmann::ordered_json& row, const char* key, const std::string& text) {
  if (text.empty()) return;
  if (isPrintableUtf8(text)) {
    row[key] = text;
  } else {
    row[std::string(key) + hexMark] = hexOf(std::as_bytes(std::span(text.data(), text.size())));
  }
}

std::string takeText(const recorder::JsonObject& object, const std::string& key) {
  std::string text;
  const std::string other = key + hexMark;
  if (object.has(key)) {
    if (object.has(other)) object.fail(fmt::format("both \"{}\" and \"{}\" are given", key, other));
    object.read(key, text, maxRowText);
  } else if (object.has(other)) {
    std::string hex;
    object.read(other, hex, 2 * maxRowText);
    text.resize(hex.size() / 2);
    takeHex(object.at(other), std::as_writable_bytes(std::span(text.data(), text.size())));
  }
  return text;
}

std::vector<recorder::KeyRule> textKeys(const std::string& key) { return {{key, false}, {key + hexMark, false}}; }

void takeHex(const recorder::JsonPlace& place, std::span<std::byte> out) {
  if (!decodeHex(place.text(2 * maxRowText), out))
    place.fail(fmt::format("{} hexadecimal digits are wanted", 2 * out.size()));
}

recorder::KeyRule countKey(const std::string& key, bool required) { return {key, required, 0.0, maxRowCount}; }

std::uint64_t takeCount(const recorder::JsonObject& object, const std::string& key) {
  double value = 0.0;
  object.read(key, value);
  const auto count = static_cast<std::uint64_t>(value);
  if (static_cast<double>(count) != value) object.at(key).fail("a whole number is wanted");
  return count;
}

}  // namespace calot::analytics
