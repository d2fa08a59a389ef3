// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/wrench_gate.h"

namespace calot::recorder {
namespace {

Vec3 clamped(const Vec3& v, double longest) {
  if (!v.allFinite()) return Vec3::Zero();
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest == 0.0) return v;
  // In two steps, as the square of a huge number overflows.
  const Vec3 unit = (v / largest).normalized();
  const double length = largest * (v / largest).norm();
  return length > longest ? Vec3(longest * unit) : v;
}

}  // namespace

void WrenchGate::command(const Wrench& wrench, std::int64_t now) {
  wrench_ = {clamped(wrench.force, force_), clamped(wrench.torque, torque_)};
  commanded_ = now;
  any_ = true;
}

Wrench WrenchGate::output(std::int64_t now) const {
  if (!any_ || now - commanded_ >= watchdog) return {};
  return wrench_;
}

}  // namespace calot::recorder
