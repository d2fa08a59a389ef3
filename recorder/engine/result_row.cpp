// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/result_row.h"

#include <string>
#include <type_traits>

#include "sim/scene/version.h"
#include "sim/tissue/tissues.h"

namespace calot::recorder {

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
