// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/kinematics_source.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "recorder/base/errors.h"
#include "recorder/sources/pointing.h"
#include "recorder/sources/scene_surfaces.h"
#include "sim/math/floating_point.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr std::uint64_t approachTicks = 1000;
constexpr std::uint64_t ticksPerSecond = 1000;

// Half sides of the task region in the camera's frame (m): what the hands of one task fill around the gallbladder.
const Vec3 taskRegion(0.030, 0.020, 0.030);
constexpr double minScale = 0.1;
constexpr double maxScale = 2.0;
constexpr double lineOfSight = 1.0;    // m
constexpr double touchShare = 0.95;    // this share of the rows is no deeper ...
constexpr double touchDepth = 0.003;   // ... than this (m)
constexpr double maxDepth = 0.012;     // and none is deeper than this (m)
constexpr double longestSlide = 0.08;  // m, either way
constexpr double slideStep = 0.001;    // m
constexpr std::size_t slideRows = 300;
constexpr std::array<double, 3> shaftPoints{0.015, 0.030, 0.045};  // m from the tip

// Nearest rank; @pre values is not empty.
double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double rank = std::floor(share * static_cast<double>(values.size() - 1) + 0.5);
  return values[static_cast<std::size_t>(rank)];
}

Vec3 placed(const KinematicsMapping& m, const Vec3& positionF) {
  return m.taskCentre + m.scale * (m.axes * (positionF - m.middle));
}

// The last piece of the shaft counts too: a mapping that drove it through an organ would be no touch.
double instrumentDistance(const Vec3& tip, const Vec3& port, const SceneSurfaces& surfaces) {
  const Vec3 back = -shaftDirection(port, tip);
  double least = surfaces.signedDistance(tip);
  for (const double along : shaftPoints) least = std::min(least, surfaces.signedDistance(tip + along * back));
  return least;
}

// The least slide along the view, coming from the camera, at which the hand's motion reaches into an organ.
std::optional<double> slideToTouch(const std::vector<Vec3>& tips, const Vec3& port, const Vec3& view,
                                   const SceneSurfaces& surfaces) {
  const auto steps = static_cast<int>(2.0 * longestSlide / slideStep);
  std::vector<double> distance(tips.size());
  for (int i = 0; i <= steps; ++i) {
    const double slide = -longestSlide + slideStep * i;
    for (std::size_t p = 0; p < tips.size(); ++p)
      distance[p] = instrumentDistance(tips[p] + slide * view, port, surfaces);
    const double deepest = *std::min_element(distance.begin(), distance.end());
    if (deepest <= -maxDepth || percentile(distance, 1.0 - touchShare) <= -touchDepth) return slide;
  }
  return std::nullopt;
}

}  // namespace

KinematicsMapping mapIntoScene(const KinematicsMotion& motion, const SceneDescription& scene) {
  const FloatingPointScope environment;
  KinematicsMapping m;
  Vec3 half;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const auto& row : motion.rows) {
      for (const KinematicsPose& pose : row) values.push_back(pose.position[axis]);
    }
    const double low = percentile(values, 0.05), high = percentile(values, 0.95);
    m.middle[axis] = 0.5 * (low + high);
    half[axis] = 0.5 * (high - low);
  }
  double scale = maxScale;
  for (int axis = 0; axis < 3; ++axis) {
    if (half[axis] * scale > taskRegion[axis]) scale = taskRegion[axis] / half[axis];
  }
  m.scale = std::max(scale, minScale);

  m.axes = scene.camera.orientation;
  const Vec3 view = m.axes * Vec3::UnitZ();
  const SceneSurfaces surfaces(scene);
  const auto hit = surfaces.firstHit(scene.camera.position, scene.camera.position + lineOfSight * view);
  if (!hit) {
    throw Error(
        ErrorKind::invalid,
        "scene " + scene.name + ": the middle of the picture shows no organ; a kinematics file has no place there");
  }
  m.taskCentre = hit->point;

  const std::size_t stride = (motion.rows.size() + slideRows - 1) / slideRows;
  for (std::size_t h = 0; h < handCount; ++h) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < motion.rows.size(); i += stride)
      points.push_back(placed(m, motion.rows[i][h].position));
    m.slide[h] = slideToTouch(points, scene.hands[h].port, view, surfaces).value_or(0.0);
  }
  return m;
}

KinematicsSource::KinematicsSource(const std::filesystem::path& file, const SceneDescription& scene)
    : KinematicsSource(readKinematics(file), scene) {}

KinematicsSource::KinematicsSource(KinematicsMotion motion, const SceneDescription& scene)
    : mapping_(mapIntoScene(motion, scene)), hands_(scene.hands), camera_(scene.camera) {
  const FloatingPointScope environment;
  provenance_.kind = OperatorKind::kinematics;
  provenance_.sourceFile = motion.file;
  provenance_.sourceSha256 = motion.sha256;
  const Vec3 view = mapping_.axes * Vec3::UnitZ();
  rows_.resize(motion.rows.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    for (std::size_t h = 0; h < handCount; ++h) {
      const KinematicsPose& from = motion.rows[i][h];
      Row& row = rows_[i][h];
      row.position = placed(mapping_, from.position) + mapping_.slide[h] * view;
      row.orientation = mapping_.axes * from.orientation;
      row.jaw = std::min(notNegative(from.gripper), widestJaw);
    }
  }
}

std::uint64_t KinematicsSource::ticks() const {
  return approachTicks + (rows_.size() - 1) * ticksPerSecond / kinematicsRowsPerSecond + 1;
}

InstrumentSample KinematicsSource::sampleOf(std::size_t hand, std::uint64_t tick) const {
  InstrumentSample sample;
  sample.instrument = hands_[hand].instrument;
  const Row& first = rows_.front()[hand];
  Row row;
  if (tick < approachTicks) {
    const double s = minimumJerk(static_cast<double>(tick) / static_cast<double>(approachTicks));
    row = first;
    row.position = hands_[hand].home + s * (first.position - hands_[hand].home);
    row.jaw = s * first.jaw;
  } else {
    const std::uint64_t thirtieths = (tick - approachTicks) * kinematicsRowsPerSecond;
    const std::size_t last = rows_.size() - 1;
    const std::size_t i = std::min<std::size_t>(thirtieths / ticksPerSecond, last - 1);
    const double s = static_cast<double>(thirtieths - i * ticksPerSecond) / static_cast<double>(ticksPerSecond);
    const Row& a = rows_[i][hand];
    const Row& b = rows_[i + 1][hand];
    const Vec3 leap = b.position - a.position;
    const Vec3 leave = i > 0 ? Vec3(0.5 * (b.position - rows_[i - 1][hand].position)) : leap;
    const Vec3 arrive = i + 2 <= last ? Vec3(0.5 * (rows_[i + 2][hand].position - a.position)) : leap;
    const double s2 = s * s, s3 = s2 * s;
    row.position = (2.0 * s3 - 3.0 * s2 + 1.0) * a.position + (s3 - 2.0 * s2 + s) * leave +
                   (3.0 * s2 - 2.0 * s3) * b.position + (s3 - s2) * arrive;
    row.orientation = interpolated(a.orientation, b.orientation, s);
    row.jaw = a.jaw + s * (b.jaw - a.jaw);
  }
  sample.position = row.position;
  sample.orientation = alignedToShaft(row.orientation, shaftDirection(hands_[hand].port, row.position));
  sample.jaw = row.jaw;
  return sample;
}

bool KinematicsSource::next(std::uint64_t tick, TickSamples& out) {
  if (tick >= ticks()) return false;
  const FloatingPointScope environment;
  TickSamples samples;
  for (std::size_t h = 0; h < handCount; ++h) samples.hand[h] = sampleOf(h, tick);
  samples.camera = camera_;
  out = roundedToGrid(samples);
  return true;
}

}  // namespace calot::recorder
