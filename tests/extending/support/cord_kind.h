// SPDX-License-Identifier: GPL-3.0-or-later
// A cord that gives way: an example of a kind of tissue. As one of Calot's it would stand in a folder of sim/tissue.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/math/record.h"

namespace calot::example {

/// Of one cord, as a scene has it.
struct CordDescription {
  std::string name;
  double strength = 1.0;  ///< pull at which it gives way (N)
};

struct CordModel {
  CordDescription description;
};

/// Of one cord, as State has it.
struct CordState {
  bool whole = true;
};

/// Of one cord, as a step reports it.
struct CordResult {
  double pull = 0.0;

  template <class Visit>
  static void fields(Visit&& visit) {
    visit(ResultField{"pull", "N", "", 7, "on the cord at the end of the step"}, &CordResult::pull);
  }
};

struct CordKind {
  using Result = CordResult;
  static constexpr const char* componentPrefix = "cord.";
  static constexpr bool hasStructures = false;  // nothing touches it
  static constexpr ResultGroup results{"/observables/cords", 7, "one column a cord"};

  struct Descriptions {
    std::vector<CordDescription> cords;
  };
  struct Models {
    std::vector<CordModel> cordModel;
  };
  struct States {
    std::vector<CordState> cords;
  };
  struct Results {
    std::vector<CordResult> cords;
  };
  struct Names {};

  template <class Self, class Visit>
  static void components(Self& self, Visit&& visit) {
    for (std::size_t c = 0; c < self.cords.size(); ++c) visit(componentPrefix, c, self.cords[c]);
  }
  static auto& resultsOf(auto& results) { return results.cords; }

  static std::string build(const Descriptions& scene, Models& model) {
    for (const CordDescription& each : scene.cords) {
      if (!(each.strength > 0.0)) return "cord " + each.name + ": strength must be above 0 N";
      model.cordModel.push_back({each});
    }
    return {};
  }
  static void start(const Models& model, States& states) { states.cords.assign(model.cordModel.size(), {}); }
  static bool fits(const Models& model, const States& states) { return states.cords.size() == model.cordModel.size(); }
};

}  // namespace calot::example
