// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/camera_rig.h"

#include <fmt/format.h>

#include "sim/math/record.h"

namespace calot::recorder {
namespace {

constexpr double mostPixels = 100000.0;
constexpr const char* sideNames[handCount] = {"left", "right"};

std::vector<Field> trocarsFields() {
  using S = CameraRig;
  return {
      object("trocars", "Trocars that were measured"),
      optional("left", at<S, &S::trocar, 0>, "Left hand's"),
      optional("right", at<S, &S::trocar, 1>, "Right hand's"),
  };
}

}  // namespace

std::vector<Field> RigCamera::fields() {
  using S = RigCamera;
  using Lens = CameraLens;
  return {
      object("oneCamera", "Lens (Brown's model) and pose of a camera"),
      {"width", at<S, &S::lens, &Lens::width>, "pixels", within(16, mostPixels), "Width of the image"},
      {"height", at<S, &S::lens, &Lens::height>, "pixels", within(16, mostPixels), "Height of the image"},
      {"focal", at<S, &S::lens, &Lens::focal>, "pixels", within(1, 1e6), "Focal length across and down"},
      {"centre", at<S, &S::lens, &Lens::centre>, "pixels", within(-mostPixels, mostPixels),
       "Principal point, from the upper left corner"},
      {"distortion", at<S, &S::lens, &Lens::distortion>, "", within(-10, 10), "k1, k2 radial; p1, p2 tangential"},
      {"readout", at<S, &S::lens, &Lens::readout>, "s", within(0, 1),
       "From the first row's exposure to the last one's"},
      {"views", at<S, &S::lens, &Lens::views>, "", within(0, 10000), "Views of the board"},
      {"coverage", at<S, &S::lens, &Lens::coverage>, "1", within(0, 1),
       "Share of the image in which the board was seen"},
      {"residual", at<S, &S::lens, &Lens::residual>, "pixels", within(0, mostPixels),
       "Root mean square reprojection error"},
      {"focalUncertainty", at<S, &S::lens, &Lens::focalUncertainty>, "1", within(0, 1e6),
       "Relative standard deviation of the focal length"},
      {"position", at<S, &S::fromDevice, &Pose::position>, "m", within(-10, 10),
       "Position of the first camera in this one's frame"},
      {"orientation", at<S, &S::fromDevice, &Pose::orientation>,
       "Unit quaternion w, x, y, z: the first camera's coordinates to this one's"},
      {"pairResidual", at<S, &S::pairResidual>, "pixels", within(0, mostPixels),
       "Root mean square reprojection error with the first camera's views"},
  };
}

std::vector<Field> Trocar::fields() {
  using S = Trocar;
  return {
      object("trocar", "Point through which the shaft passes"),
      {"point", at<S, &S::point>, "m", within(-10, 10), "Its position in the device's frame"},
      {"residual", at<S, &S::residual>, "m", within(0, 10), "Root mean square distance of the shaft from it"},
  };
}

std::vector<Field> RigLimits::fields() {
  using S = RigLimits;
  return {
      object("cameraLimits", "Largest values; of coverage and views the smallest"),
      {"lensResidual", at<S, &S::lensResidual>, "pixels", within(0, mostPixels), "Reprojection error, also of a pair"},
      {"focalUncertainty", at<S, &S::focalUncertainty>, "1", within(0, 1e6), "Relative, of the focal length"},
      {"coverage", at<S, &S::coverage>, "1", within(0, 1), "Share of the image"},
      {"views", at<S, &S::views>, "", within(0, 10000), "Views of the board"},
      {"trocarResidual", at<S, &S::trocarResidual>, "m", within(0, 10), "Distance of the shaft from its trocar"},
      {"scaleError", at<S, &S::scaleError>, "1", within(0, 10), "Difference of the strokes' scale from 1"},
  };
}

std::vector<Field> CameraRig::fields() {
  using S = CameraRig;
  return {
      object("camera", "Cameras; the device's frame is the first one's: x right, y down, z away"),
      {"printScale", at<S, &S::printScale>, "1", within(0.1, 10), "Length on the printed sheets per length meant"},
      Field("cameras", at<S, &S::cameras>, "One or two").items(1, 2),
      {"trocars", keyGroup<S, trocarsFields>, "Trocars that were measured"},
      {"limits", at<S, &S::limits>, "Limits that the values must meet"},
  };
}

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
