// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/state_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <type_traits>

#include "sim/scene/version.h"
#include "sim/tissue/tissues.h"

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
  void operator()(const char* /*name*/, const auto& value) {
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

std::optional<KeyframeDifference> differenceOf(const Model& model, const Keyframe& recorded, const Keyframe& here) {
  if (recorded.state == here.state) {
    if (recorded.haptics == here.haptics) return std::nullopt;
    return KeyframeDifference{"haptics", ""};
  }
  State a;
  State b;
  if (!restoreState(model, recorded.state, a) || !restoreState(model, here.state, b))
    return KeyframeDifference{"state", "the recorded bytes are not a State of this scene's model"};
  const auto difference = firstDifference(stateFields(model, a), stateFields(model, b));
  if (!difference) return KeyframeDifference{"state", ""};
  return KeyframeDifference{difference->field, fmt::format("index {}: recorded {}, here {}", difference->index,
                                                           difference->first, difference->second)};
}

namespace {

/// "u1" to "f8".
template <class T>
std::string typeName() {
  const char* kind = std::is_floating_point_v<T> ? "f" : std::is_signed_v<T> ? "i" : "u";
  return kind + std::to_string(sizeof(T));
}

/// A result with as many parts of each kind as the scene has.
StepResult emptyResult(const Model& model) {
  StepResult result;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId id) {
    auto& parts = Kind::resultsOf(result);
    if constexpr (Kind::hasStructures) {
      for (const StructureModel& s : model.structures()) parts.resize(parts.size() + (s.kind == id ? 1 : 0));
    } else {
      for (const std::string& c : model.layout().components)
        parts.resize(parts.size() + (c.starts_with(Kind::componentPrefix) ? 1 : 0));
    }
  });
  for (HandResult& hand : result.hand) hand.structureForce.resize(model.structures().size());
  return result;
}

struct ListColumns {
  std::vector<wire::Column>& columns;

  template <class T>
  void one(const ResultGroup& group, const ResultField& field, const T& value) {
    if constexpr (std::is_same_v<T, std::vector<double>>) {
      add<double>(group, field, value.size());
    } else if constexpr (std::is_same_v<T, Vec3>) {
      add<double>(group, field, 3);
    } else if constexpr (std::is_same_v<T, Quat>) {
      add<double>(group, field, 4);
    } else {
      add<T>(group, field, 1);
    }
  }
  template <class Part, class T>
  void each(const ResultGroup& group, const ResultField& field, const std::vector<Part>& parts, T Part::*) {
    if (!parts.empty()) add<T>(group, field, parts.size());
  }

 private:
  template <class T>
  void add(const ResultGroup& group, const ResultField& field, std::size_t width) {
    columns.push_back({std::string(group.path) + "/" + field.name, typeName<T>(), static_cast<std::uint32_t>(width)});
  }
};

struct WriteRow {
  ByteWriter writer;

  template <class T>
  void one(const ResultGroup&, const ResultField&, const T& value) {
    if constexpr (std::is_same_v<T, std::vector<double>>) {
      for (const double v : value) writer.write(v);
    } else if constexpr (std::is_same_v<T, Quat>) {
      writer.write(wire::Rotation{value.w(), value.x(), value.y(), value.z()});
    } else {
      writer.write(value);
    }
  }
  template <class Part, class T>
  void each(const ResultGroup&, const ResultField&, const std::vector<Part>& parts, T Part::*member) {
    for (const Part& part : parts) writer.write(part.*member);
  }
};

}  // namespace

std::vector<wire::Column> resultColumns(const Model& model) {
  std::vector<wire::Column> columns;
  const StepResult result = emptyResult(model);
  StepResult::fields(result, stepResultVersion, ListColumns{columns});
  return columns;
}

void appendResultRow(const StepResult& result, wire::Bytes& out) {
  StepResult::fields(result, stepResultVersion, WriteRow{ByteWriter(out)});
}

}  // namespace calot::recorder
