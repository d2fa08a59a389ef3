// SPDX-License-Identifier: GPL-3.0-or-later
// Vessels: ducts and arteries, beams along a curve with a tube around them. Vessels that branch are solved together.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/math/record.h"
#include "sim/tissue/structure.h"
#include "sim/vessel/beam_model.h"
#include "sim/vessel/beam_state.h"
#include "sim/vessel/tube_surface.h"

namespace calot {

/// Support of an end of a vessel.
struct VesselEndDescription {
  enum class Kind : std::uint8_t {
    free,   ///< not at all
    fixed,  ///< at its place at rest
    organ,  ///< grown to an organ: goes where the tissue there goes
    vessel  ///< grows out of an earlier vessel, at its node nearest to the end; starts only
  };
  Kind kind = Kind::free;
  std::string to;            ///< name of that organ or vessel
  double stiffness = 200.0;  ///< of all springs of an end that is grown to an organ together (N/m); not in scene files
  double damping = 0.0;      ///< the same (N s/m)

  static std::vector<Field> fields();
};

/// A duct or an artery: a tube along a curve (sim/vessel/beam_model.h).
struct VesselDescription {
  std::string name;
  std::string appearance;
  StructureRole role = StructureRole::other;
  std::vector<Vec3> path;        ///< points that the centre line passes at rest, from start to end, in W (m)
  std::uint32_t elements = 40;   ///< of equal length
  double radius = 0.0015;        ///< outer (m)
  double wall = 0.0005;          ///< thickness (m)
  MaterialDescription material;  ///< of the wall
  double ultimateStrain = 0.6;   ///< stretch at which it tears
  double burnThrough = 1.0;      ///< cautery at one spot that parts it (s)
  double friction = 0.1;         ///< Coulomb coefficient of an instrument on it
  VesselEndDescription start, end;

  static std::vector<Field> fields();
};

/// Vessels that grow out of one another, solved together: branch b is the scene's vessel vessel[b].
struct VesselTree {
  std::string name;  ///< of its first vessel
  BeamModel beams;
  std::vector<std::size_t> vessel;
};

/// Skins of vessels as contact and pictures have them.
inline constexpr TubeSurface::Settings tubeSettings{8, 1};

/// One vessel at the end of a step.
struct VesselResult {
  double maxStrain = 0.0;
  double maxTension = 0.0;
  double maxDisplacement = 0.0;
  std::uint32_t clips = 0;
  std::uint32_t partings = 0;
  double charred = 0.0;
  bool asleep = false;
  double covered = 0.0;
  double injured = 0.0;

  template <class Visit>
  static void fields(Visit&& visit) {
    visit(ResultField{"largest_strain", "1", "", 3,
                      "stretch (length / reference length - 1) of any whole element; 0 asleep"},
          &VesselResult::maxStrain);
    visit(ResultField{"largest_tension", "N", "", 3, "tension in any whole element; 0 asleep"},
          &VesselResult::maxTension);
    visit(ResultField{"largest_displacement", "m", "", 3,
                      "of any node of the vessels that it grows together with, from the reference configuration"},
          &VesselResult::maxDisplacement);
    visit(ResultField{"clips", "", "", 3, "clips on it"}, &VesselResult::clips);
    visit(ResultField{"partings", "", "", 3, "places where it is cut, burned or torn through"},
          &VesselResult::partings);
    visit(ResultField{"charred", "1", "", 3, "most cautery at any spot, as a share of what parts it"},
          &VesselResult::charred);
    visit(ResultField{"asleep", "", "", 3, "1: untouched and idle, not solved in this step"}, &VesselResult::asleep);
    visit(ResultField{"covered", "1", "", 4,
                      "share that is left of the fat within 1.5 mm of its wall in the reference configuration; 0 for a "
                      "vessel that the scene's procedure does not divide"},
          &VesselResult::covered);
    visit(
        ResultField{"injured_length", "m", "", 5,
                    "length of wall that cautery injured: it had the scene's share `injury` of what parts it, or more"},
        &VesselResult::injured);
  }
};

/// A clip on a vessel.
struct ClipView {
  Pose pose;             ///< of its middle in W: z along the vessel, x in the direction in which it flattens it, y
                         ///< from its crotch to the tips of its legs
  double width = 0.0;    ///< along the vessel (m)
  double legs = 0.0;     ///< their length, along y (m)
  double halfGap = 0.0;  ///< half of what it leaves to the vessel, along x (m)
};

/// Vessels as a kind of tissue; sim/tissue/tissues.h documents the members.
struct VesselTissue {
  using Result = VesselResult;
  static constexpr const char* componentPrefix = "vessels.";
  static constexpr bool hasStructures = true;
  static constexpr ResultGroup results{"/observables/vessels", 3,
                                       "one column a vessel, in the order of `/scene/vessels`"};

  struct Descriptions {
    std::vector<VesselDescription> vessels;
  };
  static Field sceneKey();
  struct Models {
    std::vector<VesselTree> vesselTree;

    [[nodiscard]] const std::vector<VesselTree>& vesselTrees() const { return vesselTree; }
  };
  struct States {
    std::vector<BeamState> vessel;  ///< per tree
  };
  struct Results {
    std::vector<VesselResult> vessel;
  };
  struct Names {
    std::vector<std::string> vessels;
  };

  template <class Self, class Visit>
  static void components(Self& self, Visit&& visit) {
    for (std::size_t t = 0; t < self.vessel.size(); ++t) visit("vessels.", t, self.vessel[t]);
  }
  static auto& resultsOf(auto& results) { return results.vessel; }
  static auto& namesOf(auto& names) { return names.vessels; }

  static std::string build(const SceneDescription& scene, Model& model);
  static void listStructures(const Model& model, TissueId kind, std::size_t firstBody,
                             std::vector<StructureModel>& structures);
  static std::size_t bodies(const Models& models) { return models.vesselTrees().size(); }
  static const std::string& nameOf(const Model& model, std::size_t index);
  static void start(const Model& model, States& states);
  static bool fits(const Model& model, const States& states);
  static void resize(const Model& model, Results& results);
  static std::unique_ptr<TissueViewer> makeViewer(const Model& model);
};

}  // namespace calot
