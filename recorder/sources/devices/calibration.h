// SPDX-License-Identifier: GPL-3.0-or-later
// Calibration of a device: measurements, date and verdict (schemas/calibration.schema.json).
// The measurements of a calibration, from samples. All of one hand, in the order of time.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/sources/devices/camera/camera_rig.h"
#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_script.h"

namespace calot::recorder {

/// Measurements of one hand's tool. What could not be measured with this device is absent.
struct HandCalibration {
  std::optional<Vec3> tipOffset;        ///< p_IT: the tool's tip in its sensor's frame (m)
  std::optional<double> pivotResidual;  ///< root mean square distance of the tip from its dimple (m)
  std::optional<double> scale;          ///< true length per measured length
  std::optional<double> scaleSpread;    ///< largest deviation of a stroke's own scale from it, relative
  std::optional<Quat> axes;             ///< q_CD: D's coordinates to right, down, away
  std::optional<double> axesResidual;   ///< largest angle between a stroke and its axis (rad)
  Vec3 noise = Vec3::Zero();            ///< root mean square at rest, each axis of D (m)
  double rate = 0.0;                    ///< samples a second
  double jitter = 0.0;                  ///< standard deviation of the intervals (s)
  double longInterval = 0.0;            ///< their 99th percentile, nearest rank (s)
  double invalidShare = 0.0;            ///< of all samples

  static std::vector<Field> fields();
};

/// Limits that a calibration must meet; stored in it, since limits change.
struct CalibrationLimits {
  double pivotResidual = 0.0015;  ///< m
  double scaleSpread = 0.03;
  double axesResidual = 0.1;  ///< rad
  double noise = 0.0005;      ///< m, each axis
  double rate = 20.0;         ///< samples a second, at least
  double longInterval = 0.1;  ///< s
  double invalidShare = 0.02;

  static std::vector<Field> fields();
};

struct Calibration {
  std::string device;    ///< class
  std::string identity;  ///< DeviceInfo::identity that it belongs to
  std::string date;      ///< ISO 8601 with Z
  std::uint32_t validDays = 30;
  std::array<std::optional<HandCalibration>, handCount> hand;
  std::string latency = "not measured";  ///< or a time with its unit
  std::string force = "not applicable";  ///< or the largest error with its unit
  CalibrationLimits limits;
  std::optional<CameraRig> camera;  ///< of cameras that watch printed handles
  /// Mouse: motion of the hand per pixel (m), as declared; not measured.
  std::optional<double> declaredPixel;

  static std::vector<Field> fields();
};

/// Violated limits, one phrase each; empty: passed. Rate, noise, intervals and invalid share must be present for at
/// least one hand; other absent values are not violations.
std::vector<std::string> shortcomings(const Calibration& calibration);

/// Whole days from its date to `now` (ISO 8601 with Z); negative where it lies in the future.
/// @pre both are dates as isDate() takes them.
std::int64_t ageInDays(const Calibration& calibration, const std::string& now);

/// The file's text; what is copied into each recording is its compact form, on one line.
std::string calibrationText(const Calibration& calibration, bool compact);

/// @throws Error (damaged) with file and JSON pointer.
Calibration readCalibration(const std::filesystem::path& file);
Calibration parseCalibration(std::span<const std::byte> bytes, const std::string& file);

/// Decides whether an attempt may use it. Another device's is never used. Assessment mode also refuses one that fell
/// short, is out of date or dated in the future, or lacks a hand that the device drives at the same time as others.
/// @throws Error (refused) naming the file and why.
void checkCalibration(const Calibration& calibration, const DeviceInfo& device, Mode mode, const std::string& now,
                      const std::string& file);

/// Valid samples of a hand in all phases of that name.
std::vector<DeviceSample> samplesIn(const DeviceScript& stream, Hand hand, const std::string& phase);

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

/// Measurements of each hand in a stream with phases (device_script.h): "rest" (noise), "pivot", "stroke right",
/// "stroke down", "stroke away"; rate, intervals and invalid share over the whole of it.
/// @param strokeLength m, as stated by who moved the tool.
/// @throws Error (damaged) where the stream has no phase "rest", or fewer than 20 samples in it for every hand; where a
/// phase "pivot" does not turn the tool enough or the strokes are not three axes.
Calibration measureCalibration(const DeviceScript& stream, double strokeLength, const DeviceInfo& device);

/// Nothing is measured for a mouse: its counts are exact, and how far the hand moves for one is the system's
/// setting. Whoever sets the station up says it. Rate and intervals are the device's by its making.
/// @param pixel how far the hand moves for a pixel (m)
/// @throws Error (invalid) for a device of another class, or a length that no mouse has
Calibration declaredCalibration(const DeviceInfo& device, double pixel);

}  // namespace calot::recorder
