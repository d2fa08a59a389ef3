// SPDX-License-Identifier: GPL-3.0-or-later
// Common part of protocols and forms: named, versioned JSON texts identified by their hash.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "recorder/base/files.h"
#include "sim/math/record.h"

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

/// Names are printed, and typed.
inline constexpr TextRule plainName{maxName, "^[A-Za-z0-9_.-]+$",
                                    "a name of letters, digits, points, hyphens and underscores is expected"};
inline constexpr TextRule anyName{maxName}, anyText{maxText};

/// Notes where a document was read from, its text and the hash of that.
inline void keepText(std::span<const std::byte> bytes, const std::string& file, DeclaredDocument& document) {
  document.file = file;
  document.text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  document.sha256 = recorder::sha256Hex(bytes);
}

}  // namespace calot::analytics
