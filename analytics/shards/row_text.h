// SPDX-License-Identifier: GPL-3.0-or-later
// What rows of values files share: text of any bytes, and whole numbers beyond 32 bits (schemas/values.md). Internal to
// this folder.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "recorder/base/json_reader.h"

namespace calot::analytics {

/// Of any text of a row (bytes).
inline constexpr std::size_t maxRowText = 65536;
/// Of a count in a row: what a double holds exactly.
inline constexpr double maxRowCount = 9007199254740992.0;

/// Writes text under `key`: nothing if it is empty; as KEY_hex where it is no printable UTF-8.
void putText(nlohmann::ordered_json& row, const char* key, const std::string& text);
/// Reads what putText() wrote. @pre the object's rule has textKeys(key).
std::string takeText(const recorder::JsonObject& object, const std::string& key);
/// Both keys of a text.
std::vector<recorder::KeyRule> textKeys(const std::string& key);

std::string hexOf(std::span<const std::byte> bytes);
/// @throws Error (damaged) unless the text is `out.size()` bytes in hexadecimal
void takeHex(const recorder::JsonPlace& place, std::span<std::byte> out);

/// A count below 2^53.
recorder::KeyRule countKey(const std::string& key, bool required = true);
std::uint64_t takeCount(const recorder::JsonObject& object, const std::string& key);

}  // namespace calot::analytics
