// SPDX-License-Identifier: GPL-3.0-or-later
// Fat: a potential field that the energised hook carves, on coarse cubes (sim/fat).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/fat/fat_model.h"
#include "sim/math/record.h"
#include "sim/tissue/structure.h"

namespace calot {

/// Attachment of fat to an organ or a vessel: springs over the fat that is no farther from it than `distance`.
struct FatAttachmentDescription {
  std::string to;           ///< name of an organ or a vessel
  double distance = 0.002;  ///< from its rest surface (m)
  double stiffness = 2e6;   ///< of a unit volume of fat that hangs on it (N/m^4)
  double damping = 2e4;     ///< (N s/m^4)

  static std::vector<Field> fields();
};

/// Fat that the energised hook carves: a potential field over coarse cubes (sim/carving, sim/solid).
struct FatDescription {
  std::string name;
  std::string appearance;
  StructureRole role = StructureRole::other;
  SurfaceDescription surface;
  double cellSize = 0.00075;       ///< of the potential field (m)
  std::uint32_t cellsPerCube = 3;  ///< edge of a mechanical cube in cells
  MaterialDescription material{1000.0, 0.4, 920.0, 2.0, 0.01};
  double friction = 0.1;  ///< Coulomb coefficient of an instrument on it
  std::vector<FatAttachmentDescription> attachments;
  /// Region to be cleared: all fat over or under this triangle (m, reference configuration), up to `triangleDepth`.
  std::array<Vec3, 3> triangle{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  double triangleDepth = 0.0;  ///< m; 0: nothing

  static std::vector<Field> fields();
};

/// One body of fat at the end of a step.
struct FatResult {
  double volume = 0.0;
  double toClear = 0.0;
  double carved = 0.0;
  double islands = 0.0;
  double maxDisplacement = 0.0;
  double maxSpeed = 0.0;
  double residual = 0.0;
  std::uint32_t iterations = 0;
  bool asleep = false;
  double uncleared = 0.0;
  bool holdsSpecimen = false;

  template <class Visit>
  static void fields(Visit&& visit) {
    visit(ResultField{"volume", "m^3", "", 3, "that is left, in the reference configuration"}, &FatResult::volume);
    visit(ResultField{"to_clear", "m^3", "", 3, "the part of it inside the region that is to be cleared"},
          &FatResult::toClear);
    visit(ResultField{"carved", "m^3", "", 3, "that the hook took in this step"}, &FatResult::carved);
    visit(ResultField{"islands", "m^3", "", 3, "that came loose by that and left"}, &FatResult::islands);
    visit(ResultField{"largest_displacement", "m", "", 3, "over its nodes, from the reference configuration"},
          &FatResult::maxDisplacement);
    visit(ResultField{"largest_speed", "m/s", "", 3, "over its nodes"}, &FatResult::maxSpeed);
    visit(ResultField{"residual", "1", "", 3, "relative residual of the linear solve; 0 asleep"}, &FatResult::residual);
    visit(ResultField{"iterations", "", "", 3, "of the linear solve; 0 asleep"}, &FatResult::iterations);
    visit(ResultField{"asleep", "", "", 3, "1: untouched and idle, not solved in this step"}, &FatResult::asleep);
    visit(ResultField{"uncleared", "1", "", 4,
                      "to_clear as a share of what was there before anything was carved; 0 without such a region"},
          &FatResult::uncleared);
    visit(
        ResultField{"holds_specimen", "", "", 7,
                    "1: connected fat joins the scene's `specimen`, or a piece of vessel that hangs on it alone, with "
                    "what stays"},
        &FatResult::holdsSpecimen);
  }
};

/// Fat as a kind of tissue; sim/tissue/tissues.h documents the members.
struct FatTissue {
  using Result = FatResult;
  static constexpr const char* componentPrefix = "fat.";
  static constexpr bool hasStructures = true;
  static constexpr ResultGroup results{"/observables/fat", 3, "one column a body of fat, in the order of `/scene/fat`"};

  /// Region of a FatModel that is to be cleared, where its description marks one.
  static constexpr std::size_t regionToClear = 0;

  struct Descriptions {
    std::vector<FatDescription> fat;
  };
  static Field sceneKey();
  struct Models {
    std::vector<std::unique_ptr<FatModel>> fatModel;

    [[nodiscard]] const std::vector<std::unique_ptr<FatModel>>& fat() const { return fatModel; }
  };
  struct States {
    std::vector<FatState> fat;
  };
  struct Results {
    std::vector<FatResult> fat;
  };
  struct Names {
    std::vector<std::string> fat;
  };

  template <class Self, class Visit>
  static void components(Self& self, Visit&& visit) {
    for (std::size_t f = 0; f < self.fat.size(); ++f) visit("fat.", f, self.fat[f].solid);
    for (std::size_t f = 0; f < self.fat.size(); ++f) visit("carved.", f, self.fat[f].carved);
  }
  static auto& resultsOf(auto& results) { return results.fat; }
  static auto& namesOf(auto& names) { return names.fat; }

  static std::string build(const SceneDescription& scene, Model& model);
  static void listStructures(const Model& model, TissueId kind, std::size_t firstBody,
                             std::vector<StructureModel>& structures);
  static std::size_t bodies(const Models& models) { return models.fat().size(); }
  static const std::string& nameOf(const Model& model, std::size_t index);
  static void start(const Model& model, States& states);
  static bool fits(const Model& model, const States& states);
  static void resize(const Model& model, Results& results);
  static std::unique_ptr<TissueViewer> makeViewer(const Model& model);
};

}  // namespace calot
