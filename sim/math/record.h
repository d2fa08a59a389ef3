// SPDX-License-Identifier: GPL-3.0-or-later
// Fields of a record, each declared once: name, unit, range, text and meaning beside the place of its value in a
// struct. A struct that files describe has `static std::vector<Field> fields()`, defined in its .cpp file:
//
//   using S = ClipDescription;
//   return {
//       object("clip", "Clips"),
//       {"width", at<S, &S::width>, "m", above(0, 0.01), "Width along the vessel"},
//   };
//
// Readers, writers, schemas and tables of the documentation run over that list; it knows none of them. Defaults are
// those of the struct's members.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim/math/fields.h"

namespace calot {

struct Field;
struct Record;

/// The table of a struct. @tparam Rows gives its rows, the first an object()
template <class S, std::vector<Field> (*Rows)() = &S::fields>
const Record& recordOf();

/// Numbers that a field admits. An open bound is excluded.
struct Range {
  double lower = 0.0, upper = 0.0;
  bool lowerOpen = false, upperOpen = false;
};

constexpr Range within(double lower, double upper) { return {lower, upper}; }
constexpr Range above(double lower, double upper) { return {lower, upper, true}; }         ///< (lower, upper]
constexpr Range below(double lower, double upper) { return {lower, upper, false, true}; }  ///< [lower, upper)

/// Text that a field admits: UTF-8 of one line, never empty.
struct TextRule {
  std::size_t longest = 0;        ///< bytes
  const char* pattern = nullptr;  ///< regular expression (ECMAScript) of the whole text; null: any
  const char* wanted = nullptr;   ///< meaning of the pattern, for messages
};

/// Words that a field admits, each with the number of its enumerator.
using FieldWords = std::vector<std::pair<std::string, std::uint32_t>>;

/// Type of a value, and its place in an object. Values are reached through `void*`; a const object may be passed to
/// `get` where `has` holds and nothing is written.
struct Access {
  enum class Type : std::uint8_t { numbers, rotation, integer, flag, text, word, record, list, bytes };
  Type type = Type::bytes;  ///< `bytes`: in no file; `rotation`: a unit quaternion
  std::size_t size = 0;     ///< of a plain value, in bytes
  std::size_t count = 0;  ///< of numbers in a row, or of the items of a list of fixed length; 0: one number, any length
  void* (*get)(void* object) = nullptr;           ///< null: checked in files and stored nowhere
  bool (*has)(const void* object) = nullptr;      ///< of a std::optional, which `get` fills; null: always there
  const Record& (*record)() = nullptr;            ///< of a record
  void (*reset)(void* value) = nullptr;           ///< of a record: its defaults
  const Access* item = nullptr;                   ///< of a list
  std::size_t (*items)(const void*) = nullptr;    ///< likewise
  void* (*itemAt)(void*, std::size_t) = nullptr;  ///< likewise
  void* (*append)(void*) = nullptr;               ///< likewise; null: of fixed length
};

namespace record_detail {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct Items : std::false_type {};
template <class T>
struct Items<std::vector<T>> : std::true_type {};
template <class T, std::size_t N>
struct Items<std::array<T, N>> : std::bool_constant<!std::is_same_v<T, double>> {};

template <class T>
constexpr Access accessOf();
template <class T>
inline constexpr Access accessTo = accessOf<T>();

template <class T>
constexpr Access accessOf() {
  using Type = Access::Type;
  Access a;
  a.size = sizeof(T);
  if constexpr (requires { T::fields(); }) {
    a.type = Type::record;
    a.record = &recordOf<T>;
    a.reset = [](void* value) { *static_cast<T*>(value) = T(); };
  } else if constexpr (Items<T>::value) {
    a.type = Type::list;
    a.item = &accessTo<typename T::value_type>;
    a.items = [](const void* list) { return static_cast<const T*>(list)->size(); };
    a.itemAt = [](void* list, std::size_t i) -> void* { return &(*static_cast<T*>(list))[i]; };
    if constexpr (requires(T & list) { list.emplace_back(); })
      a.append = [](void* list) -> void* { return &static_cast<T*>(list)->emplace_back(); };
    else
      a.count = std::tuple_size_v<T>;
  } else if constexpr (std::is_same_v<T, std::string>) {
    a.type = Type::text;
  } else if constexpr (std::is_same_v<T, Quat>) {
    a.type = Type::rotation;
  } else if constexpr (std::is_same_v<T, bool>) {
    a.type = Type::flag;
  } else if constexpr (std::is_enum_v<T>) {
    a.type = Type::word;
  } else if constexpr (std::is_integral_v<T> && sizeof(T) == sizeof(std::uint32_t)) {
    a.type = Type::integer;
  } else if constexpr (std::is_same_v<T, double>) {
    a.type = Type::numbers;
  } else if constexpr (requires { std::tuple_size<T>::value; }) {
    a.type = Type::numbers;
    a.count = std::tuple_size_v<T>;
  } else if constexpr (requires { requires std::is_same_v<typename T::Scalar, double>; }) {
    a.type = Type::numbers;
    a.count = T::RowsAtCompileTime;
  }
  return a;
}

/// The value that a path of members and indices leads to.
template <class T>
constexpr T& follow(T& object) {
  return object;
}
template <auto First, auto... Rest, class T>
constexpr auto& follow(T& object) {
  if constexpr (std::is_integral_v<decltype(First)>)
    return follow<Rest...>(object[First]);
  else
    return follow<Rest...>(object.*First);
}

template <class S, auto... Path>
constexpr Access accessAt() {
  using Value = std::remove_reference_t<decltype(follow<Path...>(std::declval<S&>()))>;
  if constexpr (IsOptional<Value>::value) {
    Access a = accessOf<typename Value::value_type>();
    a.get = [](void* object) -> void* {
      Value& value = follow<Path...>(*static_cast<S*>(object));
      return value ? &*value : &value.emplace();
    };
    a.has = [](const void* object) { return follow<Path...>(*static_cast<const S*>(object)).has_value(); };
    return a;
  } else {
    Access a = accessOf<Value>();
    a.get = [](void* object) -> void* { return &follow<Path...>(*static_cast<S*>(object)); };
    return a;
  }
}

}  // namespace record_detail

/// Access to a member of S, or to what a path of members and indices leads to.
template <class S, auto... Path>
inline constexpr Access at = record_detail::accessAt<S, Path...>();

/// A value that files may state and that is stored nowhere.
template <class T>
inline constexpr Access unstored = record_detail::accessTo<T>;

/// A value that the reader's caller checks and reads.
inline constexpr Access unchecked = {};

struct Field {
  const char* name = "";  ///< key in files; empty: of the struct alone
  Access value;
  const char* unit = "";  ///< of its numbers; "1": a share or ratio; "": none
  Range range;            ///< of each of its numbers
  TextRule text;          ///< of its text, or of each text of a list
  FieldWords words;
  const char* meaning = "";         ///< one clause
  std::size_t least = 0, most = 0;  ///< items of a list
  bool required = true;

  Field(const char* key, const Access& access, const char* unitOf, const Range& numbers, const char* what)
      : name(key), value(access), unit(unitOf), range(numbers), meaning(what) {}
  Field(const char* key, const Access& access, const char* what) : name(key), value(access), meaning(what) {}
  Field(const char* key, const Access& access, const TextRule& rule, const char* what)
      : name(key), value(access), text(rule), meaning(what) {}
  Field(const char* key, const Access& access, FieldWords known, const char* what)
      : name(key), value(access), words(std::move(known)), meaning(what) {
    if (value.type != Access::Type::list) value.type = Access::Type::word;
  }
  /// In no file.
  explicit Field(const Access& access) : value(access), required(false) {}

  [[nodiscard]] Field items(std::size_t fewest, std::size_t greatest) const {
    Field field = *this;
    field.least = fewest;
    field.most = greatest;
    return field;
  }
};

/// A field that a file may omit.
template <class... Part>
Field optional(const char* key, const Access& access, Part&&... parts) {
  Field field(key, access, std::forward<Part>(parts)...);
  field.required = false;
  return field;
}

/// First row of a table: the object's name in schemas, empty for a whole file, and its meaning.
inline Field object(const char* name, const char* meaning) { return {name, Access{}, meaning}; }

/// The keys with which each file begins.
inline Field fileFormat(const char* format) {
  enum class Format : std::uint8_t {};
  return {"format", unstored<Format>, FieldWords{{format, 0}}, "Kind of file"};
}
inline Field fileFormatVersion() {
  return {"formatVersion", unstored<std::uint32_t>, "", within(1, 1), "Version of this schema"};
}

/// A table.
struct Record {
  const char* name;
  const char* meaning;
  std::vector<Field> fields;
  const void* defaults;  ///< an object as its struct's members begin

  Record(const std::vector<Field>& rows, const void* begin)
      : name(rows.front().name), meaning(rows.front().meaning), fields(rows.begin() + 1, rows.end()), defaults(begin) {}
};

template <class S, std::vector<Field> (*Rows)()>
const Record& recordOf() {
  static const S defaults;
  static const Record record(Rows(), &defaults);
  return record;
}

/// Further fields of the same object, which stand in an object of their own in files.
template <class S, std::vector<Field> (*Rows)()>
inline constexpr Access keyGroup = {
    .type = Access::Type::record, .get = [](void* object) { return object; }, .record = &recordOf<S, Rows>};

/// One field of what a step reports. Each part of StepResult lists its fields once, by pointers to its members:
/// @code
///   template <class Visit> static void fields(Visit&& visit) {
///     visit(ResultField{"volume", "m^3", "", 1, "of the deformed tetrahedra"}, &OrganResult::volume);
///   }
/// @endcode
/// The recording's columns, schemas/observables.md, comparison, equality and tests all run over that list.
struct ResultField {
  const char* name;     ///< of the data set; stored, never reused
  const char* unit;     ///< of its numbers; "1": a share or ratio; "": none
  const char* frame;    ///< of a vector or rotation, "p_WI"; "": none
  std::uint32_t since;  ///< version of StepResult that brought it
  const char* meaning;  ///< one line, for schemas/observables.md
};

/// The fields of one kind of part, and the group of a recording that holds them.
struct ResultGroup {
  const char* path;     ///< "/observables/organs"
  std::uint32_t since;  ///< version of StepResult that brought the group
  const char* meaning;
};

}  // namespace calot
