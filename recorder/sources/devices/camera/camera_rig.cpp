// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/camera/camera_rig.h"

#include <fmt/format.h>

#include "recorder/base/identity.h"
#include "recorder/sources/json_values.h"

namespace calot::recorder {
namespace {

constexpr double mostPixels = 100000.0;
const ObjectRule rigRule{"camera", {{"printScale", true, 0.1, 10}, {"cameras"}, {"trocars"}, {"limits"}}};
const ObjectRule trocarsRule{"trocars", {{"left", false}, {"right", false}}};

JsonValues valuesOf(RigCamera& camera) {
  CameraLens& lens = camera.lens;
  return {{{"width", true, 16, mostPixels}, &lens.width},
          {{"height", true, 16, mostPixels}, &lens.height},
          {{"focal", true, 1, 1e6}, std::span(lens.focal.data(), 2)},
          {{"centre", true, -mostPixels, mostPixels}, std::span(lens.centre.data(), 2)},
          {{"distortion", true, -10, 10}, std::span(lens.distortion)},
          {{"readout", true, 0, 1}, &lens.readout},
          {{"views", true, 0, 10000}, &lens.views},
          {{"coverage", true, 0, 1}, &lens.coverage},
          {{"residual", true, 0, mostPixels}, &lens.residual},
          {{"focalUncertainty", true, 0, 1e6}, &lens.focalUncertainty},
          {{"position", true, -10, 10}, &camera.fromDevice.position},
          {{"orientation", true, -1, 1}, &camera.fromDevice.orientation},
          {{"pairResidual", true, 0, mostPixels}, &camera.pairResidual}};
}

JsonValues valuesOf(Trocar& trocar) {
  return {{{"point", true, -10, 10}, &trocar.point}, {{"residual", true, 0, 10}, &trocar.residual}};
}

JsonValues valuesOf(RigLimits& l) {
  return {{{"lensResidual", true, 0, mostPixels}, &l.lensResidual},
          {{"focalUncertainty", true, 0, 1e6}, &l.focalUncertainty},
          {{"coverage", true, 0, 1}, &l.coverage},
          {{"views", true, 0, 10000}, &l.views},
          {{"trocarResidual", true, 0, 10}, &l.trocarResidual},
          {{"scaleError", true, 0, 10}, &l.scaleError}};
}

}  // namespace

std::vector<std::string> rigShortcomings(const CameraRig& rig) {
  std::vector<std::string> out;
  const RigLimits& limit = rig.limits;
  for (std::size_t i = 0; i < rig.cameras.size(); ++i) {
    const CameraLens& lens = rig.cameras[i].lens;
    if (!(lens.views >= limit.views))
      out.push_back(fmt::format("camera {}: {} views of the board, at least {:g}", i + 1, lens.views, limit.views));
    if (!(lens.residual <= limit.lensResidual))
      out.push_back(fmt::format("camera {} lens residual: {:.2f} pixels, at most {:.2f}: keep the board flat and still",
                                i + 1, lens.residual, limit.lensResidual));
    if (!(lens.focalUncertainty <= limit.focalUncertainty))
      out.push_back(fmt::format("camera {} focal length: uncertain by {:.1f} %, at most {:.1f} %: tilt the board more",
                                i + 1, 100.0 * lens.focalUncertainty, 100.0 * limit.focalUncertainty));
    if (!(lens.coverage >= limit.coverage))
      out.push_back(fmt::format("camera {}: the board was seen in {:.0f} % of the image, at least {:.0f} %", i + 1,
                                100.0 * lens.coverage, 100.0 * limit.coverage));
    if (!(rig.cameras[i].pairResidual <= limit.lensResidual))
      out.push_back(fmt::format("camera {} beside camera 1: {:.2f} pixels, at most {:.2f}: did a camera move?", i + 1,
                                rig.cameras[i].pairResidual, limit.lensResidual));
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    if (rig.trocar[h] && !(rig.trocar[h]->residual <= limit.trocarResidual))
      out.push_back(fmt::format("{} trocar: the shaft misses it by {:.1f} mm, at most {:.1f}", handNames[h],
                                1e3 * rig.trocar[h]->residual, 1e3 * limit.trocarResidual));
  }
  return out;
}

nlohmann::ordered_json rigJson(CameraRig rig) {
  auto cameras = nlohmann::ordered_json::array(), trocars = nlohmann::ordered_json::object();
  for (RigCamera& camera : rig.cameras) cameras.push_back(jsonOf(valuesOf(camera)));
  for (std::size_t h = 0; h < handCount; ++h) {
    if (rig.trocar[h]) trocars[handNames[h]] = jsonOf(valuesOf(*rig.trocar[h]));
  }
  return {{"printScale", rig.printScale},
          {"cameras", cameras},
          {"trocars", trocars},
          {"limits", jsonOf(valuesOf(rig.limits))}};
}

CameraRig rigOf(const JsonPlace& place) {
  const JsonObject o = place.object(rigRule);
  CameraRig rig;
  o.read("printScale", rig.printScale);
  for (const JsonPlace& camera : o.at("cameras").list(1, 2)) readValues(camera, valuesOf(rig.cameras.emplace_back()));
  const JsonObject trocars = o.at("trocars").object(trocarsRule);
  for (std::size_t h = 0; h < handCount; ++h) {
    if (trocars.has(handNames[h])) readValues(trocars.at(handNames[h]), valuesOf(rig.trocar[h].emplace()));
  }
  readValues(o.at("limits"), valuesOf(rig.limits));
  return rig;
}

namespace {

Eigen::Vector2d bent(const CameraLens& lens, const Eigen::Vector2d& x) {
  const auto [k1, k2, p1, p2] = lens.distortion;
  const double r2 = x.squaredNorm();
  const double radial = 1.0 + r2 * (k1 + r2 * k2);
  return {x[0] * radial + 2.0 * p1 * x[0] * x[1] + p2 * (r2 + 2.0 * x[0] * x[0]),
          x[1] * radial + 2.0 * p2 * x[0] * x[1] + p1 * (r2 + 2.0 * x[1] * x[1])};
}

}  // namespace

Eigen::Vector2d projected(const CameraLens& lens, const Vec3& point) {
  return bent(lens, point.head<2>() / point.z()).cwiseProduct(lens.focal) + lens.centre;
}

Eigen::Vector2d undistorted(const CameraLens& lens, const Eigen::Vector2d& pixel) {
  const Eigen::Vector2d seen = (pixel - lens.centre).cwiseQuotient(lens.focal);
  Eigen::Vector2d x = seen;
  // Fixed point; a webcam's distortion contracts by a factor of five or more each time.
  constexpr int rounds = 25;
  for (int i = 0; i < rounds; ++i) x += seen - bent(lens, x);
  return x;
}

}  // namespace calot::recorder
