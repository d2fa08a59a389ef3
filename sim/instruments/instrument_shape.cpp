// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/instruments/instrument_shape.h"

#include <algorithm>

#include "sim/instruments/shape_builder.h"

namespace calot {

InstrumentShape instrumentShape(InstrumentKind kind, double jaw, double shaftRadius, double length) {
  InstrumentShape shape;
  const InstrumentDefinition& definition = instrumentOf(kind);
  if (definition.shape == nullptr) return shape;
  ShapeBuilder builder(shape, jaw, shaftRadius, length);
  definition.shape(builder);
  builder.measure();
  return shape;
}

InstrumentShape placed(const InstrumentShape& shape, const Pose& pose) {
  InstrumentShape out = shape;
  const Mat3 rotation = pose.orientation.toRotationMatrix();
  for (std::size_t k = 0; k < out.count_; ++k) {
    out.capsule_[k].p0 = pose.position + rotation * shape.capsule_[k].p0;
    out.capsule_[k].p1 = pose.position + rotation * shape.capsule_[k].p1;
  }
  return out;
}

std::pair<Vec3, Vec3> graspLine(const InstrumentDefinition& instrument, double shaftRadius) {
  return {Vec3(0.0, 0.0, -instrument.teethLength * (shaftRadius / nominalRadius)), Vec3::Zero()};
}

}  // namespace calot
