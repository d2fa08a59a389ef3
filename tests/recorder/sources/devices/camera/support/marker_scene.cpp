// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/recorder/sources/devices/camera/support/marker_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "recorder/sources/devices/camera/handle_fit.h"

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

}  // namespace

GreyImage rendered(const RigCamera& camera, const std::vector<Body>& bodies, double time, const Imaging& imaging,
                   Random& random, const std::optional<Occluder>& occluder) {
  const CameraLens& lens = camera.lens;
  const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  std::vector<double> grey(pixels);
  for (int y = 0; y < lens.height; ++y) {
    for (int x = 0; x < lens.width; ++x)  // a room, out of focus
      grey[static_cast<std::size_t>(y * lens.width + x)] =
          95.0 + 25.0 * std::sin(0.011 * x) * std::cos(0.017 * y + 0.003 * x);
  }
  const int moments = std::max(1, imaging.moments), samples = imaging.samples;
  const double share = 1.0 / (moments * samples * samples);
  // The part of the picture that paper may fill.
  int left = lens.width, right = 0, top = lens.height, bottom = 0;
  for (const double at :
       {time - 0.5 * (imaging.exposure + lens.readout), time, time + 0.5 * (imaging.exposure + lens.readout)}) {
    for (const Paper& p : papersAt(camera, bodies, at)) {
      for (const double u : {-paperHalf, paperHalf}) {
        for (const double v : {-paperHalf, paperHalf}) {
          const Vec3 corner = p.origin + u * p.right + v * p.down;
          if (corner.z() < 0.05) continue;
          const Eigen::Vector2d pixel = projected(lens, corner);
          left = std::min(left, static_cast<int>(std::floor(pixel.x())) - 3);
          right = std::max(right, static_cast<int>(std::ceil(pixel.x())) + 3);
          top = std::min(top, static_cast<int>(std::floor(pixel.y())) - 3);
          bottom = std::max(bottom, static_cast<int>(std::ceil(pixel.y())) + 3);
        }
      }
    }
  }
  left = std::max(left, 0);
  top = std::max(top, 0);
  right = std::min(right, lens.width);
  bottom = std::min(bottom, lens.height);
  for (int y = top; y < bottom; ++y) {
    std::vector<std::vector<Paper>> papers;
    for (int m = 0; m < moments; ++m) {
      const double within = moments > 1 ? (m + 0.5) / moments - 0.5 : 0.0;
      papers.push_back(
          papersAt(camera, bodies, time + lens.readout * ((y + 0.5) / lens.height - 0.5) + imaging.exposure * within));
    }
    for (int x = left; x < right; ++x) {
      double& value = grey[static_cast<std::size_t>(y * lens.width + x)];
      const double behind = value;
      double sum = 0.0;
      for (int i = 0; i < samples * samples; ++i) {
        const Eigen::Vector2d pixel(x + (i % samples + 0.5) / samples, y + (i / samples + 0.5) / samples);
        const Eigen::Vector2d direction = undistorted(lens, pixel);
        const Vec3 ray(direction.x(), direction.y(), 1.0);
        for (const std::vector<Paper>& moment : papers) {
          double depth = 1e9, seen = behind;
          for (const Paper& p : moment) {
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
    const double value = grey[i] * imaging.light * (1.0 + imaging.gradient * across) + imaging.noise * random.normal();
    out.pixels[i] = static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
  }
  return out;
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
