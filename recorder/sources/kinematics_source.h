// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "recorder/sources/source.h"
#include "recorder/sources/tracked_motion.h"
#include "sim/scene/description.h"

namespace calot::recorder {

/// Mapping of a file's frame F into the scene (docs/explanation/sources.md): p_W = taskCentre + slide_h view + scale
/// R_WC (p_F - middle).
struct KinematicsMapping {
  Vec3 middle = Vec3::Zero();  ///< p_F: of the central 90 % of both hands' positions, axis by axis (m)
  double scale = 1.0;
  Vec3 taskCentre =
      Vec3::Zero();  ///< p_W: where the line of sight through the picture's middle meets the first organ (m)
  Quat axes = Quat::Identity();  ///< q_WC of the scene's camera: F is read as x right, y down, z away from the operator
  std::array<double, handCount> slide{};  ///< along the view, so that the hand touches (m)
};

/// An attempt from a kinematics file: approach from the home positions in one second, then the file's motion.
///
/// Row i falls on tick 1000 + i * 1000 / 30; between rows positions follow a cubic Hermite curve with
/// Catmull-Rom tangents (one-sided at both ends), orientations the normalised linear interpolation on the
/// shorter arc, grippers a straight line. The instrument goes through its port: of the file's orientation only
/// the roll is left (alignedToShaft). Jaw opening is the gripper angle clamped to [0, 1.2] rad: below zero is a
/// closed gripper that presses.
class KinematicsSource : public SampleSource {
 public:
  /// @throws Error as readKinematics; invalid where the scene's camera looks at no organ.
  KinematicsSource(const std::filesystem::path& file, const SceneDescription& scene);
  KinematicsSource(KinematicsMotion motion, const SceneDescription& scene);

  [[nodiscard]] const Provenance& provenance() const override { return provenance_; }
  bool next(std::uint64_t tick, TickSamples& out) override;

  [[nodiscard]] const KinematicsMapping& mapping() const { return mapping_; }
  /// Number of ticks until the source ends.
  [[nodiscard]] std::uint64_t ticks() const;

 private:
  struct Row {
    Vec3 position = Vec3::Zero();
    Quat orientation = Quat::Identity();
    double jaw = 0.0;
  };
  [[nodiscard]] InstrumentSample sampleOf(std::size_t hand, std::uint64_t tick) const;

  Provenance provenance_;
  KinematicsMapping mapping_;
  std::array<HandDescription, handCount> hands_;
  CameraSample camera_;
  std::vector<std::array<Row, handCount>> rows_;  ///< in W
};

/// The mapping of a motion into a scene; from the two alone.
/// @throws Error (invalid) where the scene's camera looks at no organ.
KinematicsMapping mapIntoScene(const KinematicsMotion& motion, const SceneDescription& scene);

}  // namespace calot::recorder
