// SPDX-License-Identifier: GPL-3.0-or-later
// Strict reading of JSON: every error is one line that names file and JSON pointer.
// All faults of a JSON file at once, rather than the first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
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
  /// Keys of an object. @throws Error (damaged) if it is not an object
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
  [[nodiscard]] Vec3 vector(const Range& range) const;

 private:
  static constexpr std::size_t maxWord = 64;
  const nlohmann::json* value_;
  std::string file_, pointer_;
};

/// While one lives, objects that this thread reads note faults where reading can go on, instead of throwing the first:
/// unknown and missing keys, and values out of their range, which stay at their defaults.
class JsonFaults {
 public:
  JsonFaults();
  ~JsonFaults();
  JsonFaults(const JsonFaults&) = delete;
  JsonFaults& operator=(const JsonFaults&) = delete;

  /// In the order in which they were found, each once.
  [[nodiscard]] const std::vector<Error>& found() const { return found_; }
  void note(const Error& fault);

  /// Has this thread noted a fault at one of these places of a file, or within it?
  [[nodiscard]] static bool at(std::initializer_list<std::string_view> pointers);
  /// Notes the fault where faults are noted. @throws the fault where they are not
  static void report(const Error& fault);
  /// Runs a part of the reading whose fault does not keep other parts from being read.
  static void part(auto&& work) {
    try {
      work();
    } catch (const Error& fault) {
      report(fault);
    }
  }

 private:
  JsonFaults* outer_;
  std::vector<Error> found_;
};

}  // namespace calot::recorder
