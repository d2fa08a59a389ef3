// SPDX-License-Identifier: GPL-3.0-or-later
// How a member of a struct is bound to a statement and read from a row, by its type (declared_tables.cpp alone).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <concepts>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "analytics/cohort/tables.h"

namespace calot::analytics {

static_assert(std::endian::native == std::endian::little, "the file's doubles are little-endian");

inline void bindMember(SQLite::Statement& s, int i, const std::string& value) { s.bind(i, value); }
inline void bindMember(SQLite::Statement& s, int i, double value) { s.bind(i, value); }
template <class T>
requires std::integral<T> || std::is_enum_v<T>
void bindMember(SQLite::Statement& s, int i, T value) { s.bind(i, static_cast<std::int64_t>(value)); }
/// An array's or a vector's bytes. A null pointer would be NULL, even with no bytes.
template <class T>
void bindBytes(SQLite::Statement& s, int i, const T& values) {
  static const double none = 0.0;
  const void* from = values.empty() ? static_cast<const void*>(&none) : values.data();
  s.bind(i, from, static_cast<int>(values.size() * sizeof(values[0])));
}
template <std::size_t N>
void bindMember(SQLite::Statement& s, int i, const std::array<std::byte, N>& bytes) {
  bindBytes(s, i, bytes);
}
inline void bindMember(SQLite::Statement& s, int i, const std::vector<double>& values) { bindBytes(s, i, values); }
template <class T>
void bindMember(SQLite::Statement& s, int i, const std::optional<T>& value) {
  if (value) {
    bindMember(s, i, *value);
  } else {
    s.bind(i);
  }
}

/// Reuses the text's memory: a large cohort has millions of cells.
inline void readMember(const SQLite::Column& from, std::string& to) {
  const char* begin = from.getText();
  to.assign(begin, static_cast<std::size_t>(from.getBytes()));
}
inline void readMember(const SQLite::Column& from, double& to) { to = from.getDouble(); }
template <class T>
requires std::integral<T> || std::is_enum_v<T>
void readMember(const SQLite::Column& from, T& to) { to = static_cast<T>(from.getInt64()); }
template <std::size_t N>
void readMember(const SQLite::Column& from, std::array<std::byte, N>& to) {
  std::memcpy(to.data(), from.getBlob(), std::min<std::size_t>(N, static_cast<std::size_t>(from.getBytes())));
}
inline void readMember(const SQLite::Column& from, std::vector<double>& to) {
  to.resize(static_cast<std::size_t>(from.getBytes()) / sizeof(double));
  if (!to.empty()) std::memcpy(to.data(), from.getBlob(), to.size() * sizeof(double));
}
template <class T>
void readMember(const SQLite::Column& from, std::optional<T>& to) {
  to.reset();
  if (!from.isNull()) readMember(from, to.emplace());
}

/// Values that lists show: anything but bytes.
template <class T>
concept Listed = std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string> ||
    std::is_same_v<T, std::optional<double>>;

template <Listed T>
FieldValue fieldOf(const T& value) {
  if constexpr (std::is_same_v<T, std::optional<double>>) {
    return value ? FieldValue(*value) : FieldValue();
  } else if constexpr (requires { recorder::wordFor(value); }) {
    return recorder::wordFor(value);
  } else if constexpr (std::is_enum_v<T>) {
    return nameOf(value);
  } else if constexpr (std::unsigned_integral<T> && !std::is_same_v<T, bool>) {
    return std::uint64_t{value};
  } else {
    return value;
  }
}

template <class Row, auto... Path>
constexpr auto fieldReader() -> FieldValue (*)(const void* row) {
  if constexpr (requires(const Row& row) { fieldOf((row.*....*Path)); }) {
    return [](const void* row) { return fieldOf((*static_cast<const Row*>(row).*....*Path)); };
  } else {
    return nullptr;
  }
}

/// The member of `Row` that the path leads to, through its base classes too.
template <class Row, auto... Path>
inline constexpr ColumnMember inRow{
    [](SQLite::Statement& s, int i, const void* row) { bindMember(s, i, (*static_cast<const Row*>(row).*....*Path)); },
    [](const SQLite::Column& from, void* row) { readMember(from, (*static_cast<Row*>(row).*....*Path)); },
    fieldReader<Row, Path...>()};

template <class Row, class Member>
Row classOf(Member Row::*);

/// The same of the class that declares the first member: at<&Row::part, &Part::member>.
template <auto First, auto... Path>
inline constexpr ColumnMember at = inRow<decltype(classOf(First)), First, Path...>;

/// An unsigned number of 64 bits as text in decimal: SQLite's integers are signed.
template <auto Member>
inline constexpr ColumnMember digits{
    [](SQLite::Statement& s, int i, const void* row) {
      s.bind(i, std::to_string(static_cast<const decltype(classOf(Member))*>(row)->*Member));
    },
    [](const SQLite::Column& from, void* row) {
      static_cast<decltype(classOf(Member))*>(row)->*Member = std::strtoull(from.getText(), nullptr, 10);
    },
    fieldReader<decltype(classOf(Member)), Member>()};

}  // namespace calot::analytics
