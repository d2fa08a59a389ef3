// SPDX-License-Identifier: GPL-3.0-or-later
// Common part of protocols and forms: named, versioned JSON texts identified by their hash.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "recorder/base/json_reader.h"

namespace calot::analytics {

inline constexpr std::size_t maxName = 64, maxText = 2000;

struct DeclaredDocument {
  std::string name;
  std::uint32_t version = 1;
  std::string title;
  std::string file;    ///< base name, for messages
  std::string text;    ///< as it was read
  std::string sha256;  ///< of the text, hexadecimal
};

/// A checkpoint with its subject, "path-length left"; of an outcome or external metric its name alone.
inline std::string figureName(const std::string& checkpoint, const std::string& subject) {
  return subject.empty() ? checkpoint : checkpoint + " " + subject;
}

/// Letters, digits, points, hyphens and underscores: names are printed, and typed.
bool isPlainName(const std::string& name);
std::string plainName(const recorder::JsonPlace& place);

/// Reads "format" (which must be the word `format`), "formatVersion", name, version and title; keeps the text.
/// @throws Error (damaged) naming file and place.
void readHead(const recorder::JsonObject& root, const std::string& format, std::span<const std::byte> bytes,
              const std::string& file, DeclaredDocument& document);

}  // namespace calot::analytics
