// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/kept/recorded_names.h"

#include <fmt/format.h>

#include <vector>

#include "recorder/base/text_words.h"

namespace calot::recorder {

namespace {

std::string listFault(const char* what, const std::vector<std::string>& recorded, const std::vector<std::string>& own) {
  if (recorded.size() != own.size())
    return fmt::format("has {} {}s, and its scene {}", recorded.size(), what, own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (recorded[i] != own[i])
      return fmt::format("{} {} is called {}, and by its scene {}", what, i, shown(recorded[i]), shown(own[i]));
  }
  return "";
}

}  // namespace

std::string nameFault(const DigestLayout& recorded, const DigestLayout& engine) {
  if (std::string fault = listFault("component", recorded.components, engine.components); !fault.empty()) return fault;
  std::vector<std::string> names, own;
  for (const DigestLayout::Field& field : recorded.fields)
    names.push_back(fmt::format("{} of component {}", field.name, field.component));
  for (const DigestLayout::Field& field : engine.fields)
    own.push_back(fmt::format("{} of component {}", field.name, field.component));
  return listFault("field", names, own);
}

std::string nameFault(const AttemptHeader& header, const Model& model) {
  std::string fault;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId kind) {
    if constexpr (Kind::hasStructures) {
      if (!fault.empty() || Kind::results.since > header.stepResultVersion) return;
      std::vector<std::string> own;
      for (const StructureModel& structure : model.structures()) {
        if (structure.kind == kind) own.push_back(structure.name);
      }
      fault = listFault("structure", Kind::namesOf(header), own);
    }
  });
  return fault.empty() ? nameFault(header.layout, model.layout()) : fault;
}

}  // namespace calot::recorder
