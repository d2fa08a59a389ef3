// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/state_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <type_traits>

namespace calot::recorder {

namespace {

struct Flatten {
  std::vector<double> reals;
  std::vector<std::uint64_t> wholes;
  bool real = false;

  void add(double v) {
    real = true;
    reals.push_back(v);
  }
  template <class T>
  requires(std::is_integral_v<T> || std::is_enum_v<T>) void add(T v) {
    wholes.push_back(static_cast<std::uint64_t>(v));
  }
  void add(const Vec3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(const Quat& q) {
    for (const double v : {q.w(), q.x(), q.y(), q.z()}) add(v);
  }
  template <class T, std::size_t N>
  void add(const std::array<T, N>& values) {
    for (const T& v : values) add(v);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    if constexpr (!std::is_integral_v<T>) real = true;
    for (const T& v : values) add(v);
  }
};

struct FlattenVisitor {
  std::vector<StateField>& out;
  const DigestLayout& layout;
  template <class T>
  void operator()(const char* /*name*/, const T& value) {
    Flatten flat;
    flat.add(value);
    const std::string& name = layout.fields[out.size()].name;
    if (flat.real) {
      out.push_back({name, std::move(flat.reals)});
    } else {
      out.push_back({name, std::move(flat.wholes)});
    }
  }
};

template <class T>
std::optional<std::uint64_t> firstIndex(const std::vector<T>& a, const std::vector<T>& b) {
  const std::size_t n = std::min(a.size(), b.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (std::bit_cast<std::uint64_t>(a[i]) != std::bit_cast<std::uint64_t>(b[i])) return i;
  }
  if (a.size() != b.size()) return n;
  return std::nullopt;
}

std::string valueAt(const StateField& field, std::uint64_t index) {
  return std::visit(
      [&](const auto& values) -> std::string {
        return index < values.size() ? fmt::format("{}", values[index]) : "absent";
      },
      field.values);
}

}  // namespace

std::vector<StateField> stateFields(const Model& model, const State& state) {
  std::vector<StateField> fields;
  FlattenVisitor visitor{fields, model.layout()};
  State::components(state, [&](const auto& part) { std::remove_cvref_t<decltype(part)>::fields(part, visitor); });
  return fields;
}

std::optional<FieldDifference> firstDifference(const std::vector<StateField>& first,
                                               const std::vector<StateField>& second) {
  for (std::size_t f = 0; f < std::max(first.size(), second.size()); ++f) {
    if (f >= first.size()) return FieldDifference{second[f].name, 0, "absent", valueAt(second[f], 0)};
    if (f >= second.size()) return FieldDifference{first[f].name, 0, valueAt(first[f], 0), "absent"};
    if (first[f].name != second[f].name) return FieldDifference{first[f].name, 0, first[f].name, second[f].name};
    std::optional<std::uint64_t> index;
    if (first[f].values.index() != second[f].values.index()) {
      index = 0;
    } else {
      index = std::visit(
          [&](const auto& a) { return firstIndex(a, std::get<std::remove_cvref_t<decltype(a)>>(second[f].values)); },
          first[f].values);
    }
    if (index) return FieldDifference{first[f].name, *index, valueAt(first[f], *index), valueAt(second[f], *index)};
  }
  return std::nullopt;
}

}  // namespace calot::recorder
