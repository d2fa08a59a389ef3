// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/camera/camera_rig.h"

#include <fmt/format.h>
#include <cmath>

namespace calot::recorder {
namespace {

constexpr double mostPixels = 100000.0;
constexpr const char* sideNames[handCount] = {"left", "right"};

const ObjectRule rigRule{"camera", {{"printScale", true, 0.1, 10}, {"cameras"}, {"trocars"}, {"limits"}}};
const ObjectRule cameraRule{"oneCamera",
                            {{"width", true, 16, mostPixels},
                             {"height", true, 16, mostPixels},
                             {"focal", true, 1, 1e6},
                             {"centre", true, -mostPixels, mostPixels},
                             {"distortion", true, -10, 10},
                             {"readout", true, 0, 1},
                             {"views", true, 0, 10000},
                             {"coverage", true, 0, 1},
                             {"residual", true, 0, mostPixels},
                             {"focalUncertainty", true, 0, 1e6},
                             {"position", true, -10, 10},
                             {"orientation", true, -1, 1},
                             {"pairResidual", true, 0, mostPixels}}};
const ObjectRule trocarsRule{"trocars", {{"left", false}, {"right", false}}};
const ObjectRule trocarRule{"trocar", {{"point", true, -10, 10}, {"residual", true, 0, 10}}};
const ObjectRule rigLimitsRule{"cameraLimits",
                               {{"lensResidual", true, 0, mostPixels},
                                {"focalUncertainty", true, 0, 1e6},
                                {"coverage", true, 0, 1},
                                {"views", true, 0, 10000},
                                {"trocarResidual", true, 0, 10},
                                {"scaleError", true, 0, 10}}};

template <class Limits, class Visitor>
void visitRigLimits(Limits& l, const Visitor& visit) {
  visit("lensResidual", l.lensResidual);
  visit("focalUncertainty", l.focalUncertainty);
  visit("coverage", l.coverage);
  visit("views", l.views);
  visit("trocarResidual", l.trocarResidual);
  visit("scaleError", l.scaleError);
}

template <class Values>
nlohmann::ordered_json listOf(const Values& values) {
  auto out = nlohmann::ordered_json::array();
  for (const double v : values) out.push_back(v);
  return out;
}

std::vector<double> numbersAt(const JsonObject& object, const ObjectRule& rule, const char* key, std::size_t count) {
  std::vector<double> out;
  for (const KeyRule& k : rule.keys) {
    if (k.key != key) continue;
    for (const JsonPlace& place : object.at(key).list(count, count)) out.push_back(place.number(k));
  }
  return out;
}

RigCamera cameraOf(const JsonPlace& place) {
  const JsonObject o = place.object(cameraRule);
  const auto numbers = [&](const char* key, std::size_t count) { return numbersAt(o, cameraRule, key, count); };
  RigCamera out;
  std::uint32_t width = 0, height = 0, views = 0;
  o.read("width", width);
  o.read("height", height);
  o.read("views", views);
  CameraLens& lens = out.lens;
  lens.width = static_cast<int>(width);
  lens.height = static_cast<int>(height);
  lens.views = static_cast<int>(views);
  lens.focal = Eigen::Vector2d(numbers("focal", 2).data());
  lens.centre = Eigen::Vector2d(numbers("centre", 2).data());
  const std::vector<double> bend = numbers("distortion", lens.distortion.size());
  std::copy(bend.begin(), bend.end(), lens.distortion.begin());
  o.read("readout", lens.readout);
  o.read("coverage", lens.coverage);
  o.read("residual", lens.residual);
  o.read("focalUncertainty", lens.focalUncertainty);
  o.read("pairResidual", out.pairResidual);
  o.read("position", out.fromDevice.position);
  const std::vector<double> q = numbers("orientation", 4);
  const Quat orientation(q[0], q[1], q[2], q[3]);
  if (!(std::abs(orientation.norm() - 1.0) <= 1e-6)) o.at("orientation").fail("is no unit quaternion w x y z");
  out.fromDevice.orientation = orientation.normalized();
  return out;
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
      out.push_back(fmt::format("{} trocar: the shaft misses it by {:.1f} mm, at most {:.1f}", sideNames[h],
                                1e3 * rig.trocar[h]->residual, 1e3 * limit.trocarResidual));
  }
  return out;
}

nlohmann::ordered_json rigJson(const CameraRig& rig) {
  nlohmann::ordered_json out{{"printScale", rig.printScale}, {"cameras", nlohmann::ordered_json::array()}};
  for (const RigCamera& camera : rig.cameras) {
    const CameraLens& lens = camera.lens;
    const Quat& q = camera.fromDevice.orientation;
    out["cameras"].push_back({{"width", lens.width},
                              {"height", lens.height},
                              {"focal", listOf(lens.focal)},
                              {"centre", listOf(lens.centre)},
                              {"distortion", listOf(lens.distortion)},
                              {"readout", lens.readout},
                              {"views", lens.views},
                              {"coverage", lens.coverage},
                              {"residual", lens.residual},
                              {"focalUncertainty", lens.focalUncertainty},
                              {"position", listOf(camera.fromDevice.position)},
                              {"orientation", listOf(std::array{q.w(), q.x(), q.y(), q.z()})},
                              {"pairResidual", camera.pairResidual}});
  }
  auto trocars = nlohmann::ordered_json::object();
  for (std::size_t h = 0; h < handCount; ++h) {
    if (rig.trocar[h])
      trocars[sideNames[h]] = {{"point", listOf(rig.trocar[h]->point)}, {"residual", rig.trocar[h]->residual}};
  }
  out["trocars"] = trocars;
  auto limits = nlohmann::ordered_json::object();
  visitRigLimits(rig.limits, [&](const char* key, double v) { limits[key] = v; });
  out["limits"] = limits;
  return out;
}

CameraRig rigOf(const JsonPlace& place) {
  const JsonObject o = place.object(rigRule);
  CameraRig rig;
  o.read("printScale", rig.printScale);
  for (const JsonPlace& camera : o.at("cameras").list(1, 2)) rig.cameras.push_back(cameraOf(camera));
  const JsonObject trocars = o.at("trocars").object(trocarsRule);
  for (std::size_t h = 0; h < handCount; ++h) {
    if (!trocars.has(sideNames[h])) continue;
    const JsonObject t = trocars.at(sideNames[h]).object(trocarRule);
    Trocar trocar;
    t.read("point", trocar.point);
    t.read("residual", trocar.residual);
    rig.trocar[h] = trocar;
  }
  const JsonObject limits = o.at("limits").object(rigLimitsRule);
  visitRigLimits(rig.limits, [&](const char* key, double& v) { limits.read(key, v); });
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
