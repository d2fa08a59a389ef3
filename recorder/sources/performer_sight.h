// SPDX-License-Identifier: GPL-3.0-or-later
// Perception of a performer: the visible surfaces, reduced to what its decisions need.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "recorder/engine/observer.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// A vessel that is to be divided, by stations a millimetre apart along its course at rest.
struct SeenVessel {
  std::vector<Vec3> centre;    ///< of each station now (m, W)
  std::vector<Vec3> along;     ///< unit, towards the specimen
  std::vector<double> clip;    ///< stations of the clips on it, ascending (m from the first)
  std::uint32_t partings = 0;  ///< points at which it is open or divided
  /// How high fat stands over each station, towards the port of the hand that works, from the centre line (m): on it,
  /// and on either side. Far below zero where there is none.
  std::vector<std::array<double, 3>> fat;
};

struct SeenStrand {
  std::array<Vec3, 2> end{Vec3::Zero(), Vec3::Zero()};  ///< on the specimen and on the liver (m, W)
  double alpha = 1.0;
  bool attached = false;
};

/// Fat over and under a place of the triangle that is to be cleared.
struct SeenColumn {
  Vec3 place = Vec3::Zero();       ///< where it is now (m, W)
  double top = 0.0, bottom = 0.0;  ///< of the fat, towards the port of the hand that works, from the place (m)
  [[nodiscard]] double fat() const { return top - bottom; }
};

struct SeenHand {
  Vec3 tip = Vec3::Zero();  ///< p_WI of the instrument in the picture (m)
  bool holds = false;       ///< its jaws hold tissue
  std::uint32_t clips = 0;  ///< left in the applier
};

struct Sight {
  std::vector<SeenVessel> vessel;
  std::vector<SeenStrand> strand;
  std::vector<SeenColumn> column;  ///< in the order of PerformerSight::columns()
  std::array<SeenHand, handCount> hand;
  Vec3 grip = Vec3::Zero();         ///< the place on the specimen that is to be held (m, W)
  Vec3 gripNormal = Vec3::UnitY();  ///< outward there, at rest
};

/// Reference positions, which an operator knows from anatomy.
class PerformerSight {
 public:
  /// Stations of a vessel are this far apart (m).
  static constexpr double spacing = 0.001;

  /// A vessel that is to be divided, from the side that stays to the specimen.
  struct VesselPlan {
    std::string name;
    double radius = 0.0;             ///< m
    std::vector<Vec3> rest;          ///< stations (m)
    std::size_t index = 0;           ///< among the scene's vessels
    std::uint32_t patientClips = 2;  ///< that should close it on the side that stays
    std::uint32_t specimenClips = 1;
  };

  /// A place of the triangle that is to be cleared, at rest.
  struct ColumnPlan {
    Vec3 place = Vec3::Zero();
    std::size_t row = 0;  ///< rows run along the triangle's first edge, from its first corner; columns in order
  };

  /// @param worker hand that carves, clips and cuts; the other one holds
  PerformerSight(const SceneDescription& scene, std::size_t worker);

  /// Perception after a step. Costs a scene view.
  [[nodiscard]] Sight look(const StepRecord& record) const;

  [[nodiscard]] const std::vector<VesselPlan>& vessels() const { return vessel_; }
  [[nodiscard]] const std::vector<ColumnPlan>& columns() const { return column_; }
  /// Stations of the vessels that are to be spared, at rest, and their radii (m).
  [[nodiscard]] const std::vector<std::pair<Vec3, double>>& spared() const { return spared_; }
  [[nodiscard]] bool hasSpecimen() const { return specimen_ < organs_; }
  [[nodiscard]] bool hasFat() const { return !fat_.empty(); }
  /// Are the vessels to be clipped and cut?
  [[nodiscard]] bool divides() const { return divides_; }
  [[nodiscard]] const Vec3& neck() const { return neck_; }  ///< of the specimen, at rest (m)

 private:
  static const SurfaceView* surfaceNamed(const SceneView& view, const std::string& name);
  /// Points `spacing` apart along a line of straight pieces.
  static std::vector<Vec3> stationsOf(const std::vector<Vec3>& path);
  void planVessels(const SceneDescription& scene);
  void planColumns(const SceneDescription& scene);
  void findSpecimen(const SceneDescription& scene);
  void seeVessel(const SceneView& view, const VesselPlan& plan, SeenVessel& seen) const;
  void seeColumns(const SceneView& view, Sight& sight) const;
  void seeFat(const SceneView& view, const VesselPlan& plan, SeenVessel& seen) const;

  std::vector<VesselPlan> vessel_;
  std::vector<ColumnPlan> column_;
  std::vector<std::pair<Vec3, double>> spared_;
  std::string bed_, fat_, specimenName_;
  std::size_t organs_ = 0, specimen_ = 0, worker_ = 1;
  std::array<Vec3, handCount> port_{Vec3::Zero(), Vec3::Zero()};
  Vec3 eye_ = Vec3::Zero();
  Vec3 neck_ = Vec3::Zero();
  bool divides_ = false;
  double triangleDepth_ = 0.0;
  std::size_t gripVertex_ = 0;
  Vec3 gripNormal_ = Vec3::UnitY();
};

}  // namespace calot::recorder
