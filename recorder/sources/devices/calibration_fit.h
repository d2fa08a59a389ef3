// SPDX-License-Identifier: GPL-3.0-or-later
// The measurements of a calibration, from samples. All of one hand, in the order of time.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/device_script.h"

namespace calot::recorder {

struct PivotFit {
  Vec3 tipOffset = Vec3::Zero();  ///< o in R_i o + t_i = p for all i (m)
  Vec3 pivot = Vec3::Zero();      ///< p, in D (m)
  double residual = 0.0;          ///< root mean square of |R_i o + t_i - p| (m)
};

/// Least squares over all poses of a tool whose tip stays in a dimple (the algebraic one-step method: Yaniv 2015,
/// "Which pivot calibration?", Proc. SPIE 9415).
/// @returns nothing for fewer than 10 poses, or where they rotate so little that the offset is not determined: the
/// smallest eigenvalue of the normal matrix, per pose, is below 0.01 (rotations of about 10 degrees about two axes).
std::optional<PivotFit> fitPivot(std::span<const DeviceSample> samples);

struct StrokeFit {
  double scale = 1.0;            ///< stated length per measured length
  Quat axes = Quat::Identity();  ///< q_CD
  double scaleSpread = 0.0;      ///< largest relative deviation of a stroke's own scale
  double axesResidual = 0.0;     ///< largest angle between axes * stroke and its axis (rad)
};

/// Rotation and scale that map three measured strokes onto the three axes right, down, away, each `length` long
/// (Umeyama 1991, IEEE PAMI 13:376, without translation).
/// @returns nothing where a stroke is shorter than a tenth of the longest, or where they are mirrored.
std::optional<StrokeFit> fitStrokes(const std::array<Vec3, 3>& strokes, double length);

/// From the mean of the first to the mean of the last tenth of the samples (at least one), of the tip.
/// @pre samples is not empty
Vec3 strokeOf(std::span<const DeviceSample> samples, const Vec3& tipOffset);

/// All that a stream with phases (device_script.h) tells of each hand: "rest" (noise), "pivot", "stroke right", "stroke
/// down", "stroke away"; rate, intervals and invalid share over the whole of it.
/// @param strokeLength m, as stated by who moved the tool.
/// @throws Error (damaged) where the stream has no phase "rest", or fewer than 20 samples in it for every hand; where a
/// phase "pivot" does not turn the tool enough or the strokes are not three axes.
Calibration measureCalibration(const DeviceScript& stream, double strokeLength, const DeviceInfo& device);

/// Nothing is measured for a mouse: its counts are exact, and how far the hand moves for one is the system's
/// setting. Whoever sets the station up says it. Rate and intervals are the device's by its making.
/// @param pixel how far the hand moves for a pixel (m)
/// @throws Error (invalid) for a device of another class, or a length that is none of a mouse
Calibration declaredCalibration(const DeviceInfo& device, double pixel);

}  // namespace calot::recorder
