// SPDX-License-Identifier: GPL-3.0-or-later
// Strict reading of JSON: every error is one line that names file and JSON pointer. The allowed content of objects is a
// table of rules, so that the reader, its messages and the published schema agree (a test compares them).
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/math/linear.h"

namespace calot::recorder {

/// One key of an object. The bounds are those of its number, or of each of its numbers; `open` excludes the bound.
struct KeyRule {
  std::string key;
  bool required = true;
  double lower = 0.0, upper = 0.0;
  bool lowerOpen = false, upperOpen = false;
};

/// One kind of object: its name in the schema's "$defs" (empty: the root), and all its keys.
struct ObjectRule {
  std::string definition;
  std::vector<KeyRule> keys;
};

/// Parses UTF-8 JSON without comments. Refuses what JSON leaves undefined: a key given twice, nesting deeper than 32
/// levels, more than 4 MiB, numbers beyond a double.
/// @param file the name that messages use.
/// @throws Error (damaged) with file, line and column.
nlohmann::json parseStrictJson(std::span<const std::byte> bytes, const std::string& file);

class JsonObject;

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

  [[nodiscard]] JsonObject object(const ObjectRule& rule) const;
  /// @pre the fault of a wrong count names `least` and `most`.
  [[nodiscard]] std::vector<JsonPlace> list(std::size_t least, std::size_t most) const;
  [[nodiscard]] std::string text(std::size_t longest) const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] double number(const KeyRule& rule) const;
  [[nodiscard]] std::uint32_t integer(const KeyRule& rule) const;
  /// Three numbers.
  [[nodiscard]] Vec3 vector(const KeyRule& rule) const;
  /// One of a few words, each with the value that it denotes.
  template <class T>
  [[nodiscard]] T word(std::initializer_list<std::pair<const char*, T>> words) const {
    const std::string given = text(maxWord);
    std::string known;
    for (const auto& [name, meaning] : words) {
      if (given == name) return meaning;
      known += (known.empty() ? "" : ", ") + std::string(name);
    }
    fail("none of " + known);
  }

 private:
  static constexpr std::size_t maxWord = 200;
  friend class JsonObject;
  const nlohmann::json* value_;
  std::string file_, pointer_;
};

/// An object checked against its rule: no unknown key, no missing one. Optional values that the file omits are left
/// unchanged.
class JsonObject {
 public:
  JsonObject(const JsonPlace& place, const ObjectRule& rule);

  [[nodiscard]] bool has(const std::string& key) const;
  /// @pre the key is there.
  [[nodiscard]] JsonPlace at(const std::string& key) const;
  [[noreturn]] void fail(const std::string& fault) const { place_.fail(fault); }

  void read(const std::string& key, double& out) const;
  void read(const std::string& key, std::uint32_t& out) const;
  void read(const std::string& key, bool& out) const;
  void read(const std::string& key, Vec3& out) const;
  /// @param longest in bytes.
  void read(const std::string& key, std::string& out, std::size_t longest) const;

 private:
  [[nodiscard]] const KeyRule& ruleOf(const std::string& key) const;
  JsonPlace place_;
  const ObjectRule* rule_;
};

}  // namespace calot::recorder
