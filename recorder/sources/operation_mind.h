// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions of a performer in scenes in which tissue is to be cleared, divided or freed, from one
// perception to the next.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "recorder/sources/performer_hand.h"
#include "recorder/sources/performer_sight.h"

namespace calot::recorder {

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

/// The hand that works: clears vessels of fat, frees the lower third of the bed, clips, cuts, frees the rest.
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
  enum class Stage : std::uint8_t { clear, window, lowerThird, clip, cut, bed, done };

  void rankStrands(const Sight& sight);
  void clear(const Sight& sight);
  struct FatStroke;
  double highestFat(const SeenVessel& vessel, double radius, FatStroke& stroke) const;
  void runStroke(const FatStroke& stroke, const SeenVessel& vessel, double radius);
  void window(Sight sight);
  bool thickestRow(const Sight& sight, std::size_t& first, std::size_t& last) const;
  void burn(const Sight& sight, bool lowerThird);
  void leaveBed(const Sight& sight, bool lowerThird);
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
  void go(const Vec3& to, double speed, double jaw, double dwell = 0.0);
  void newError();
  [[nodiscard]] PerformerHand& hand() { return tools_.hand[hand_]; }

  OperationTools tools_;
  std::size_t hand_;
  Random random_;
  Stage stage_ = Stage::clear;
  std::size_t vessel_ = 0;
  std::uint32_t strokes_ = 0, tries_ = 0, looks_ = 0;
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
