// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions of a performer in scenes in which tissue is to be cleared, divided or freed, from one
// perception to the next.
// A hand of a closed-loop performer: queued strokes become samples as time passes.
// Perception of a performer: the visible surfaces, reduced to what its decisions need.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/sources/performer_profile.h"
#include "recorder/sources/pointing.h"
#include "sim/math/random.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// A command for a hand: a straight minimum-jerk stroke, then a pause.
struct HandMove {
  enum class Aim : std::uint8_t {
    none,     ///< the roll stays as it is
    hinge,    ///< the jaws' hinge lies along `aim`, either way round
    forward,  ///< y_I, the direction of a hook's toe, is as close to `aim` as the shaft allows
  };

  Vec3 to = Vec3::Zero();  ///< p_WI where the stroke is meant to end (m)
  double speed = 0.03;     ///< mean (m/s)
  double jaw = 0.0;        ///< at its end (rad)
  Aim aiming = Aim::none;
  Vec3 aim = Vec3::UnitX();                          ///< unit, in W
  std::uint8_t buttons = 0;                          ///< while it lasts
  double dwell = 0.0;                                ///< rest at its end, buttons as they are (s)
  InstrumentKind instrument = InstrumentKind::none;  ///< mounted as the stroke begins; none: the same as before
  bool steady = false;                               ///< at constant speed, as in dissection, instead of minimum jerk
  bool sure = false;                                 ///< without the noise of its length: small corrections, and rests
};

/// Strokes are minimum-jerk (Flash and Hogan 1985) and miss the goal by noise proportional to their length (Harris and
/// Wolpert 1998); some overshoot. Tremor and drift are superposed.
class PerformerHand {
 public:
  PerformerHand(const PerformerProfile& profile, const HandDescription& hand, std::size_t index, std::uint64_t seed);

  void add(const HandMove& move);
  [[nodiscard]] std::size_t waiting() const { return queue_.size(); }
  /// Is the hand idle at `time` (s)?
  [[nodiscard]] bool idle(double time) const { return queue_.empty() && time >= end_; }
  /// Ends the current stroke within `seconds` and drops the rest of the queue.
  [[nodiscard]] bool idleIn(double seconds, double time) const { return queue_.empty() && time + seconds >= end_; }
  /// Intended position after all queued commands (m).
  [[nodiscard]] const Vec3& meant() const { return queue_.empty() ? stroke_.to : queue_.back().to; }
  [[nodiscard]] InstrumentKind instrument() const { return instrument_; }
  [[nodiscard]] const HandDescription& description() const { return hand_; }
  /// Along the shaft into the body, with the tip at p.
  [[nodiscard]] Vec3 shaft(const Vec3& p) const;

  /// @pre called with times that do not fall
  InstrumentSample sample(double time);

 private:
  struct Running {
    double start = 0.0, duration = 0.0;
    Vec3 from = Vec3::Zero(), to = Vec3::Zero();
    double jawFrom = 0.0, jawTo = 0.0, rollFrom = 0.0, rollTo = 0.0;
    std::uint8_t buttons = 0;
    bool steady = false;
  };
  void begin(double time);
  [[nodiscard]] double progress(double time) const;
  [[nodiscard]] double rollFor(const HandMove& move) const;

  const PerformerProfile& profile_;
  HandDescription hand_;
  Random random_;
  Unsteadiness tremor_, wander_;
  std::deque<HandMove> queue_;
  Running stroke_;
  double end_ = 0.0;  ///< of the stroke that runs and its rest (s)
  InstrumentKind instrument_ = InstrumentKind::none;
};

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
  bool attached = false;
};

/// Fat over and under a place of the triangle that is to be cleared.
struct SeenColumn {
  Vec3 place = Vec3::Zero();       ///< where it is now (m, W)
  double top = 0.0, bottom = 0.0;  ///< of the fat, towards the port of the hand that works, from the place (m)
  [[nodiscard]] double fat() const { return top - bottom; }
};

/// Fat that still hangs between what moved with the specimen and what stayed.
struct SeenTether {
  Vec3 place = Vec3::Zero();  ///< where it is drawn out, nearest to the port of the hand that works (m, W)
  double depth = 0.0;         ///< of it beyond that place, away from that port (m)
};

struct SeenHand {
  bool holds = false;       ///< its jaws hold tissue
  std::uint32_t clips = 0;  ///< left in the applier
};

struct Sight {
  std::vector<SeenVessel> vessel;
  std::vector<std::pair<Vec3, double>> spared;  ///< stations of the vessels that are to be spared, and their radii (m)
  std::vector<SeenStrand> strand;
  std::vector<SeenColumn> column;  ///< in the order of PerformerSight::columns()
  bool held = false;               ///< fat still holds the specimen
  std::vector<SeenTether> tether;  ///< nearest to the port first; empty while nothing is drawn out
  std::array<SeenHand, handCount> hand;
  Vec3 grip = Vec3::Zero();  ///< the place on the specimen that is to be held (m, W)
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
  /// Vessels that are to be spared, by name.
  [[nodiscard]] const std::vector<VesselPlan>& spared() const { return spared_; }
  [[nodiscard]] const std::vector<ColumnPlan>& columns() const { return column_; }
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
  void planSpared(const SceneDescription& scene);
  void findSpecimen(const SceneDescription& scene);
  void seeVessel(const SceneView& view, const VesselPlan& plan, SeenVessel& seen) const;
  void seeColumns(const SceneView& view, Sight& sight) const;
  void seeFat(const SceneView& view, const VesselPlan& plan, SeenVessel& seen) const;
  void seeTethers(const SceneView& view, Sight& sight) const;

  std::vector<VesselPlan> vessel_;
  std::vector<ColumnPlan> column_;
  std::vector<VesselPlan> spared_;
  std::string bed_, fat_, specimenName_;
  std::size_t organs_ = 0, specimen_ = 0, worker_ = 1;
  std::array<Vec3, handCount> port_{Vec3::Zero(), Vec3::Zero()};
  Vec3 eye_ = Vec3::Zero();
  Vec3 neck_ = Vec3::Zero();
  bool divides_ = false;
  double triangleDepth_ = 0.0;
  std::size_t gripVertex_ = 0, neckVertex_ = 0;
};

/// Both hands of an operation, its anatomy, and the operator's interpretation of its perception.
struct OperationTools {
  const PerformerProfile& profile;
  const SceneDescription& scene;
  const PerformerSight& anatomy;
  std::array<PerformerHand, handCount>& hand;
};

/// The hand that grasps and retracts the specimen. Grasps again if it has lost it.
class HoldingMind {
 public:
  HoldingMind(const OperationTools& tools, std::size_t hand, std::uint64_t seed);
  /// @pre the hand is idle. @param sight newest. @param freed share of the bed that is free
  /// @param divided no vessel holds the specimen any more
  void decide(const Sight& sight, double freed, bool divided);
  /// Is the specimen grasped and retracted, or is there nothing to grasp?
  [[nodiscard]] bool ready() const { return ready_; }

 private:
  enum class At : std::uint8_t { away, before, closed, pulling };
  [[nodiscard]] double wantedPull(const Sight& sight, double freed, bool divided) const;
  OperationTools tools_;
  std::size_t hand_;
  Random random_;
  At at_ = At::away;
  Vec3 error_ = Vec3::Zero(), held_ = Vec3::Zero();
  double pulled_ = 0.0;
  bool ready_ = false;
};

/// The hand that works: clears vessels of fat, frees the lower third of the bed, clips, cuts, frees the rest, and
/// divides the fat that still holds then.
class WorkingMind {
 public:
  WorkingMind(const OperationTools& tools, std::size_t hand, std::uint64_t seed);
  /// @pre the hand is idle. Adds what it does next.
  void decide(const Sight& sight);
  [[nodiscard]] bool done() const { return stage_ == Stage::done; }
  /// Has it given up after repeated failure?
  [[nodiscard]] bool failed() const { return failed_; }
  /// Freed share of the bed, relative to what was attached at the first perception.
  [[nodiscard]] double freed(const Sight& sight) const;
  /// No vessel holds the specimen any more.
  [[nodiscard]] bool divided() const { return stage_ >= Stage::bed || !tools_.anatomy.divides(); }
  /// Observes only after the tissue has settled from its actions.
  [[nodiscard]] bool stirs() const { return stirred_; }
  /// A clip sat badly or fell.
  void sawBadClip() { ++badClips_[clipped_]; }

 private:
  enum class Stage : std::uint8_t { clear, window, lowerThird, clip, cut, bed, last, done };

  void rankStrands(const Sight& sight);
  void clear(const Sight& sight);
  struct FatStroke;
  double highestFat(const SeenVessel& vessel, double radius, FatStroke& stroke) const;
  void runStroke(const FatStroke& stroke, const SeenVessel& vessel, double radius);
  void window(Sight sight);
  void search(const Sight& sight);
  /// Vessels that the hook keeps off: places of their centre lines, and radii (m).
  [[nodiscard]] std::vector<std::pair<Vec3, double>> keptOff(const Sight& sight) const;
  bool thickestRow(const Sight& sight, std::size_t& first, std::size_t& last) const;
  void burn(const Sight& sight, bool lowerThird);
  void leaveBed(const Sight& sight, bool lowerThird);
  void divideLast(const Sight& sight);
  struct BedStrand;
  struct BedStroke;
  [[nodiscard]] BedStroke bestStroke(const std::vector<BedStrand>& wanted) const;
  void runStroke(const BedStroke& stroke);
  void clip(const Sight& sight);
  [[nodiscard]] double placeForClip(const Sight& sight, std::size_t side) const;
  void cut(const Sight& sight);

  /// Goes home and comes back with another instrument. @return false where it is mounted already
  bool mount(InstrumentKind kind, double jaw);
  void strokeThrough(const std::vector<Vec3>& way, const Vec3& aim, double lift);
  /// Moves above a target, observes, and descends with corrections until the error is small. @return true
  /// when it has arrived
  bool bring(const Vec3& place, const Vec3& hinge, double above, double beyond, double jaw);
  void closeAndLeave(double opened);
  void closeAt(const SeenVessel& vessel, double place, double depth, double jaw);
  void nextVessel();
  void go(const Vec3& to, double speed, double jaw, double dwell = 0.0);
  void newError();
  [[nodiscard]] PerformerHand& hand() { return tools_.hand[hand_]; }

  OperationTools tools_;
  std::size_t hand_;
  Random random_;
  Stage stage_ = Stage::clear;
  std::size_t vessel_ = 0;
  std::uint32_t strokes_ = 0, tries_ = 0, looks_ = 0, searched_ = 0;
  std::array<std::uint32_t, 2> badClips_{0, 0};  ///< on the vessel at hand, on the side that stays and on the other
  std::size_t clipped_ = 0;                      ///< the side that the last clip was for
  bool failed_ = false, stirred_ = false;
  Vec3 error_ = Vec3::Zero();
  std::array<std::vector<std::uint32_t>, 3> fatTried_;  ///< on the vessel at hand, per lane and station: strokes
  std::vector<std::uint32_t> columnTried_;              ///< of the triangle
  std::vector<double> share_;         ///< of the strands that lie nearer to the neck, per strand, as first seen
  std::vector<std::uint32_t> tried_;  ///< per strand: strokes that should have met it
  double attachedAtFirst_ = 0.0;
};

}  // namespace calot::recorder
