// SPDX-License-Identifier: GPL-3.0-or-later
// Connective tissue between two organs, as a scene has it: strands and sheets over a bed (sim/connective).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/math/fields.h"
#include "sim/math/record.h"
#include "sim/tissue/structure.h"

namespace calot {

/// Connective tissue over the bed where one organ lies on another (sim/connective/connective_tissue.h).
struct ConnectiveDescription {
  std::string name;
  StructureRole role = StructureRole::other;
  std::string first;             ///< organ whose surface the bed is part of
  std::string second;            ///< organ that it lies on
  double reach = 0.004;          ///< triangles of the first organ no farther from the second are the bed (m)
  std::uint32_t strands = 200;   ///< minimum number
  double stiffness = 2e5;        ///< of a unit area of bed (N/m^3)
  double damping = 2e3;          ///< (N s/m^3)
  double strength = 4e3;         ///< largest traction: beyond, it softens (Pa)
  double fractureEnergy = 60.0;  ///< that tearing a unit area of bed takes (J/m^2), at least strength^2 / (2 stiffness)
  double fadeTime = 0.4;         ///< in which the energised hook burns a strand through (s)

  static std::vector<Field> fields();
};

/// Checks the cohesive law: the fracture energy must cover the energy stored at the strength. @return one clause, or
/// nothing
std::string cohesiveFault(const ConnectiveDescription& description);

/// Connective tissue between organs `a` and `b`.
struct ConnectiveModel {
  std::string name;
  std::size_t a = 0;
  std::size_t b = 0;
  ConnectiveTissue tissue;
  /// Strands of the lower, middle and upper third of the procedure's bed, ascending; empty if this is another bed or
  /// no vessel is to be divided. Thirds of the bed's area by distance, in the reference configuration, of a strand's
  /// end on the specimen from the point where the first vessel to be divided enters it.
  std::array<std::vector<std::uint32_t>, 3> third;
};

/// One connective tissue at the end of a step, as shares of its bed's area.
struct ConnectiveResult {
  double attached = 0.0;
  double burned = 0.0;
  double torn = 0.0;
  double maxPull = 0.0;
  std::uint32_t hookTouches = 0;
  double lowerAttached = 0.0;
  double middleAttached = 0.0;
  double upperAttached = 0.0;

  template <class Visit>
  static void fields(Visit&& visit) {
    visit(ResultField{"attached", "1", "", 2, "share of the bed's area whose strands are attached"},
          &ConnectiveResult::attached);
    visit(ResultField{"burned", "1", "", 2, "share that is burned away"}, &ConnectiveResult::burned);
    visit(ResultField{"torn", "1", "", 2, "share that is torn and hangs on the organs as residue"},
          &ConnectiveResult::torn);
    visit(ResultField{"largest_pull", "Pa", "", 2, "on any attached strand, per area of bed"},
          &ConnectiveResult::maxPull);
    visit(ResultField{"hook_touches", "", "", 2, "strands that the energised hook touched in this step"},
          &ConnectiveResult::hookTouches);
    visit(ResultField{"lower_attached", "1", "", 4,
                      "share of the bed's lower third that is attached; 0 for a tissue without thirds"},
          &ConnectiveResult::lowerAttached);
    visit(ResultField{"middle_attached", "1", "", 4, "the same of its middle third"},
          &ConnectiveResult::middleAttached);
    visit(ResultField{"upper_attached", "1", "", 4, "the same of its upper third"}, &ConnectiveResult::upperAttached);
  }
};

/// Connective tissue between two organs, in W: strands, and sheets between neighbouring strands.
struct ConnectiveView {
  std::string name;                                 ///< in the scene: "bed"
  std::vector<std::array<Vec3, 2>> strand;          ///< ends on the first and on the second organ (m)
  std::vector<StrandCondition> condition;           ///< per strand
  std::vector<float> alpha;                         ///< per strand: 1 intact, falling while the hook burns it
  std::vector<std::array<std::uint32_t, 2>> sheet;  ///< pairs of strands that a sheet joins while both are attached
};

/// Connective tissue as a kind of tissue; sim/tissue/tissues.h documents the members.
struct ConnectiveKind {
  using Result = ConnectiveResult;
  static constexpr const char* componentPrefix = "connective.";
  static constexpr bool hasStructures = false;
  static constexpr ResultGroup results{
      "/observables/connective", 2, "one column a connective tissue, in the order of the components `connective.NAME`"};

  struct Descriptions {
    std::vector<ConnectiveDescription> connective;
  };
  static Field sceneKey();
  struct Models {
    std::vector<ConnectiveModel> connectiveModel;

    [[nodiscard]] const std::vector<ConnectiveModel>& connective() const { return connectiveModel; }
  };
  struct States {
    std::vector<ConnectiveState> connective;
  };
  struct Results {
    std::vector<ConnectiveResult> connective;
  };
  struct Names {};

  template <class Self, class Visit>
  static void components(Self& self, Visit&& visit) {
    for (std::size_t c = 0; c < self.connective.size(); ++c) visit("connective.", c, self.connective[c]);
  }
  static auto& resultsOf(auto& results) { return results.connective; }

  static std::string build(const SceneDescription& scene, Model& model);
  static void listStructures(const Model& /*model*/, TissueId /*kind*/, std::size_t /*firstBody*/,
                             std::vector<StructureModel>& /*structures*/) {}
  static std::size_t bodies(const Models& /*models*/) { return 0; }
  static const std::string& nameOf(const Model& model, std::size_t index);
  static void start(const Model& model, States& states);
  static bool fits(const Model& model, const States& states);
  static void resize(const Model& model, Results& results);
  static std::unique_ptr<TissueViewer> makeViewer(const Model& model);
};

}  // namespace calot
