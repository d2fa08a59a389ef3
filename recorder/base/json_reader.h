// SPDX-License-Identifier: GPL-3.0-or-later
// Strict reading of JSON: every error is one line that names file and JSON pointer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/record.h"

namespace calot::recorder {

/// Parses UTF-8 JSON without comments. Refuses what JSON leaves undefined: a key given twice, nesting deeper than 32
/// levels, more than 4 MiB, numbers beyond a double.
/// @param file the name that messages use.
/// @throws Error (damaged) with file, line and column.
nlohmann::json parseStrictJson(std::span<const std::byte> bytes, const std::string& file);

/// A value and its location.
class JsonPlace {
 public:
  /// @param value must outlive the place.
  JsonPlace(const nlohmann::json& value, std::string file, std::string pointer = "")
      : value_(&value), file_(std::move(file)), pointer_(std::move(pointer)) {}

  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::string& pointer() const { return pointer_; }

  /// @throws Error (damaged): "FILE: POINTER: FAULT".
  [[noreturn]] void fail(const std::string& fault) const;

  /// Is it an object with this key?
  [[nodiscard]] bool has(const std::string& key) const;
  /// A value of an object. @throws Error (damaged) where it is no object or has no such key
  [[nodiscard]] JsonPlace at(const std::string& key) const;
  /// An item of a list. @pre it is a list of more than i items
  [[nodiscard]] JsonPlace at(std::size_t i) const { return list(i + 1, static_cast<std::size_t>(-1))[i]; }
  /// Keys of an object. @throws Error (damaged) where it is none
  [[nodiscard]] std::vector<std::string> keys() const;
  /// Place of a key, which may be absent, for messages.
  [[nodiscard]] JsonPlace named(const std::string& key) const;
  /// @pre the fault of a wrong count names `least` and `most`.
  [[nodiscard]] std::vector<JsonPlace> list(std::size_t least, std::size_t most) const;
  [[nodiscard]] std::string text(std::size_t longest) const;
  [[nodiscard]] std::string text(const TextRule& rule) const;
  /// The number of one of these words.
  [[nodiscard]] std::uint32_t word(const FieldWords& words) const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] double number(const Range& range) const;
  [[nodiscard]] std::uint32_t integer(const Range& range) const;
  /// Three numbers.
  [[nodiscard]] Vec3 vector(const Range& range) const;

 private:
  static constexpr std::size_t maxWord = 64;
  const nlohmann::json* value_;
  std::string file_, pointer_;
};

}  // namespace calot::recorder
