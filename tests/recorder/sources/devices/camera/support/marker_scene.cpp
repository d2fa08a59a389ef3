// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/recorder/sources/devices/camera/support/marker_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "recorder/sources/devices/camera/handle_tracker.h"

namespace calot::recorder::cameratest {
namespace {

const std::array<bool, 100>& cellsOf(int id) {
  static std::map<int, std::array<bool, 100>> known;
  const auto found = known.find(id);
  return found != known.end() ? found->second : known.emplace(id, tagCells(id)).first->second;
}

/// A square of paper around a tag, in the camera's frame.
struct Paper {
  Vec3 origin, right, down, normal;  // middle; unit vectors
  int id = 0;
  double shade = 1.0;
  double left = 1e9, rightmost = -1e9, top = 1e9, bottom = -1e9;  // of the picture, with a margin (pixels)
};

constexpr double paperHalf = 0.5 * tagPitch;
constexpr double cell = tagSide / 8.0;

/// Grey of the paper where a ray meets it, or nothing.
std::optional<double> greyAt(const Paper& paper, const Vec3& ray, double& depth) {
  const double along = paper.normal.dot(ray);
  if (!(along < -1e-6)) return std::nullopt;
  const double distance = paper.normal.dot(paper.origin) / along;
  if (!(distance > 0.0) || distance >= depth) return std::nullopt;
  const Vec3 at = distance * ray - paper.origin;
  const double x = paper.right.dot(at), y = paper.down.dot(at);
  if (std::abs(x) > paperHalf || std::abs(y) > paperHalf) return std::nullopt;
  depth = distance;
  const int column = static_cast<int>(std::floor(x / cell)) + 5, row = static_cast<int>(std::floor(y / cell)) + 5;
  const bool inside = column >= 0 && column < 10 && row >= 0 && row < 10;
  const bool black = inside && cellsOf(paper.id)[static_cast<std::size_t>(10 * row + column)];
  return paper.shade * (black ? 25.0 : 205.0);
}

std::vector<Paper> papersAt(const RigCamera& camera, const std::vector<Body>& bodies, double time) {
  std::vector<Paper> out;
  for (const Body& body : bodies) {
    const Pose pose = body.at(time);
    const Quat turn = camera.fromDevice.orientation * pose.orientation;
    const Vec3 origin = camera.fromDevice.position + camera.fromDevice.orientation * pose.position;
    std::vector<TagPlace> tags = body.tags;
    if (body.flap) tags.push_back(body.flap(time));
    for (const TagPlace& tag : tags) {
      Paper p{origin + turn * tag.middle, turn * tag.right, turn * tag.down, turn * tag.normal(), tag.id, 1.0};
      if (!(p.normal.dot(p.origin) < 0.0)) continue;
      // Light from above the camera.
      bool before = true;
      for (int k = 0; k < 4; ++k) {
        const Vec3 corner = p.origin + (k == 1 || k == 2 ? paperHalf : -paperHalf) * p.right +
                            (k < 2 ? paperHalf : -paperHalf) * p.down;
        before = before && corner.z() > 0.05;
        if (!before) break;
        const Eigen::Vector2d pixel = projected(camera.lens, corner);
        p.left = std::min(p.left, pixel.x() - 2.0);
        p.rightmost = std::max(p.rightmost, pixel.x() + 2.0);
        p.top = std::min(p.top, pixel.y() - 2.0);
        p.bottom = std::max(p.bottom, pixel.y() + 2.0);
      }
      if (!before) continue;
      p.shade = 0.55 + 0.45 * std::max(0.0, p.normal.dot(Vec3(0.2, -0.5, -0.85).normalized()));
      out.push_back(p);
    }
  }
  return out;
}

void blurRows(std::vector<double>& values, int width, int height, int stepX, int stepY, double sigma) {
  if (!(sigma > 0.0)) return;
  const int reach = static_cast<int>(std::ceil(3.0 * sigma));
  std::vector<double> weight;
  double sum = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    weight.push_back(std::exp(-0.5 * k * k / (sigma * sigma)));
    sum += weight.back();
  }
  const std::vector<double> from = values;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double value = 0.0;
      for (int k = -reach; k <= reach; ++k) {
        const int u = std::clamp(x + k * stepX, 0, width - 1), v = std::clamp(y + k * stepY, 0, height - 1);
        value += weight[static_cast<std::size_t>(k + reach)] * from[static_cast<std::size_t>(v * width + u)];
      }
      values[static_cast<std::size_t>(y * width + x)] = value / sum;
    }
  }
}

/// Where the middle of each pixel looks.
const std::vector<Eigen::Vector2d>& directionsOf(const CameraLens& lens) {
  static std::map<std::array<double, 4>, std::vector<Eigen::Vector2d>> known;
  std::vector<Eigen::Vector2d>& out = known[{lens.focal.x(), lens.focal.y(), lens.centre.x(), lens.centre.y()}];
  if (!out.empty()) return out;
  for (int y = 0; y < lens.height; ++y) {
    for (int x = 0; x < lens.width; ++x) out.push_back(undistorted(lens, {x + 0.5, y + 0.5}));
  }
  return out;
}

const std::vector<double>& normals() {
  static const std::vector<double> table = [] {
    Random random(77);
    std::vector<double> out(1U << 16U);
    for (double& v : out) v = random.normal();
    return out;
  }();
  return table;
}

}  // namespace

GreyImage rendered(const RigCamera& camera, const std::vector<Body>& bodies, double time, const Imaging& imaging,
                   Random& random, const std::optional<Occluder>& occluder) {
  const CameraLens& lens = camera.lens;
  const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  std::vector<double> grey(pixels), rowWave, columnWave;
  for (int y = 0; y < lens.height; ++y) rowWave.push_back(25.0 * std::cos(0.017 * y));
  for (int x = 0; x < lens.width; ++x) columnWave.push_back(std::sin(0.011 * x));
  for (int y = 0; y < lens.height; ++y) {
    for (int x = 0; x < lens.width; ++x)  // a room, out of focus
      grey[static_cast<std::size_t>(y * lens.width + x)] =
          rowWave[static_cast<std::size_t>(y)] * columnWave[static_cast<std::size_t>(x)] + 95.0;
  }
  const int moments = std::max(1, imaging.moments), samples = imaging.samples;
  const double share = 1.0 / (moments * samples * samples);
  const std::vector<Eigen::Vector2d>& directions = directionsOf(lens);
  for (int y = 0; y < lens.height; ++y) {
    std::vector<std::vector<Paper>> papers;
    double left = lens.width, right = 0.0;
    for (int m = 0; m < moments; ++m) {
      const double within = moments > 1 ? (m + 0.5) / moments - 0.5 : 0.0;
      const double row = lens.readout * ((y + 0.5) / lens.height - 0.5);
      papers.push_back(papersAt(camera, bodies, time + row + imaging.exposure * within));
      std::erase_if(papers.back(), [&](const Paper& p) { return y + 1.0 < p.top || y > p.bottom; });
      for (const Paper& p : papers.back()) {
        left = std::min(left, p.left);
        right = std::max(right, p.rightmost);
      }
    }
    const int first = std::max(0, static_cast<int>(left)), end = std::min(lens.width, static_cast<int>(right) + 1);
    for (int x = first; x < end; ++x) {
      double& value = grey[static_cast<std::size_t>(y * lens.width + x)];
      const double behind = value;
      const Eigen::Vector2d centre = directions[static_cast<std::size_t>(y * lens.width + x)];
      double sum = 0.0;
      for (int i = 0; i < samples * samples; ++i) {
        // Within a pixel the lens bends nothing.
        const Eigen::Vector2d offset((i % samples + 0.5) / samples - 0.5, (i / samples + 0.5) / samples - 0.5);
        const Eigen::Vector2d direction = centre + offset.cwiseQuotient(lens.focal);
        const Vec3 ray(direction.x(), direction.y(), 1.0);
        for (const std::vector<Paper>& moment : papers) {
          double depth = 1e9, seen = behind;
          for (const Paper& p : moment) {
            if (x + 1.0 < p.left || x > p.rightmost) continue;
            if (const std::optional<double> g = greyAt(p, ray, depth)) seen = *g;
          }
          sum += seen;
        }
      }
      value = sum * share;
    }
  }
  if (occluder) {
    for (int y = 0; y < lens.height; ++y) {
      for (int x = 0; x < lens.width; ++x) {
        if (x >= occluder->left && x < occluder->right && y >= occluder->top && y < occluder->bottom)
          grey[static_cast<std::size_t>(y * lens.width + x)] = 60.0;
      }
    }
  }
  blurRows(grey, lens.width, lens.height, 1, 0, imaging.lensBlur);
  blurRows(grey, lens.width, lens.height, 0, 1, imaging.lensBlur);
  GreyImage out{lens.width, lens.height, std::vector<std::uint8_t>(pixels)};
  for (std::size_t i = 0; i < pixels; ++i) {
    const double across = static_cast<double>(i % static_cast<std::size_t>(lens.width)) / lens.width - 0.5;
    const double value = grey[i] * imaging.light * (1.0 + imaging.gradient * across) +
                         imaging.noise * normals()[(random.next() >> 8U) % normals().size()];
    out.pixels[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
  }
  return out;
}

CameraRig shrunk(CameraRig rig, int factor) {
  for (RigCamera& camera : rig.cameras) {
    camera.lens.width /= factor;
    camera.lens.height /= factor;
    camera.lens.focal /= factor;
    camera.lens.centre /= factor;
  }
  return rig;
}

CameraLens webcam() {
  CameraLens lens;
  lens.width = 1280;
  lens.height = 720;
  lens.focal = {914.0, 911.0};
  lens.centre = {648.5, 352.0};
  lens.distortion = {-0.09, 0.03, 0.0006, -0.0004};
  return lens;
}

CameraRig rigOfCameras(int count, double readout) {
  CameraRig rig;
  RigCamera first;
  first.lens = webcam();
  first.lens.readout = readout;
  rig.cameras.push_back(first);
  if (count < 2) return rig;
  RigCamera second = first;
  second.lens.focal = {905.0, 907.0};
  second.lens.centre = {633.0, 366.0};
  // 0.25 m to the right of the first, turned towards what is 0.4 m before that.
  const double angle = std::atan2(0.25, 0.4);
  const Quat turn(std::cos(0.5 * angle), 0.0, std::sin(0.5 * angle), 0.0);
  second.fromDevice = {turn * Vec3(-0.25, 0.0, 0.0), turn};
  rig.cameras.push_back(second);
  return rig;
}

Pose posed(const Vec3& position, const Vec3& turn, const Quat& base) {
  return {position, (rotationBy(turn) * base).normalized()};
}

Pose handMotion(Hand hand, double time) {
  const double side = hand == Hand::left ? -1.0 : 1.0;
  const double phase = hand == Hand::left ? 0.7 : 0.0;
  // The shaft's z away from the hand: down and away from the camera.
  Mat3 base;
  base << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0;
  const Vec3 position(side * 0.075 + 0.03 * std::sin(1.9 * time + phase),
                      0.01 + 0.025 * std::sin(2.7 * time + 2.0 * phase), 0.40 + 0.03 * std::sin(1.3 * time + phase));
  const Vec3 turn(0.35 + 0.3 * std::sin(1.7 * time + phase), 0.6 * std::sin(0.9 * time + phase),
                  0.3 * std::sin(2.3 * time + 1.0));
  return posed(position, turn, Quat(base));
}

Body handleBody(Hand hand, std::function<Pose(double)> at) { return {handleTags(hand), std::move(at), nullptr}; }

}  // namespace calot::recorder::cameratest
