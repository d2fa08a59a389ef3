// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/beam_preload.h"

#include <vector>

#include "sim/vessel/beam_element.h"
#include "sim/vessel/frames.h"

namespace calot {

void addStiffness(const BeamModel& model, double factor, std::span<const int> row, SymmetricBlocks& matrix) {
  const BeamState rest = restState(model);
  for (std::size_t index = 0; index < model.elements().size(); ++index) {
    const BeamElement& e = model.elements()[index];
    const BeamStiffness k = stiffnessOf(e, strainOf(e, rest, index), 0.0);
    const Mat3 gat = k.ga.transpose();
    const Mat3 gbt = k.gb.transpose();
    const Mat3 axial = k.stretch * Mat3::Identity();
    const int a = row[static_cast<std::size_t>(e.a)];
    const int b = row[static_cast<std::size_t>(e.b)];
    const auto add = [&](int node, int turn, int other, int otherTurn, const Mat3& block) {
      if (node < 0 || other < 0) return;
      const int at = node + turn;
      const int with = other + otherTurn;
      matrix.add(static_cast<std::size_t>(at), static_cast<std::size_t>(with), factor * block);
    };
    add(a, 0, a, 0, axial);
    add(a, 1, a, 0, -k.stretch * gat);
    add(a, 1, a, 1, k.stretch * (gat * k.ga) + k.bend);
    add(b, 0, b, 0, axial);
    add(b, 1, b, 0, k.stretch * gbt);
    add(b, 1, b, 1, k.stretch * (gbt * k.gb) + k.bend);
    add(b, 0, a, 0, -axial);
    add(b, 0, a, 1, k.stretch * k.ga);
    add(b, 1, a, 0, -k.stretch * gbt);
    add(b, 1, a, 1, k.stretch * (gbt * k.ga) - k.bend);
  }
}

void preload(BeamModel& model, std::span<const Vec3> displacement, std::span<const Vec3> rotation) {
  const BeamState rest = restState(model);
  std::vector<BeamElement> loaded = model.elements();
  for (std::size_t index = 0; index < loaded.size(); ++index) {
    BeamElement& e = loaded[index];
    const auto a = static_cast<std::size_t>(e.a);
    const auto b = static_cast<std::size_t>(e.b);
    const BeamStrain s = strainOf(e, rest, index);
    const BeamStiffness k = stiffnessOf(e, s, 0.0);
    const Vec3 force = k.stretch * (displacement[b] - displacement[a] + k.ga * rotation[a] + k.gb * rotation[b]);
    const Vec3 moment = k.bend * (rotation[b] - rotation[a]);
    const Mat3 toMiddle = blend(rest.orientation[a], rest.orientation[b], 0.5).toRotationMatrix().transpose();
    e.slack -= toMiddle * force / e.stretching;
    const double twist = s.axis.dot(moment);
    const Vec3 turn = (moment - twist * s.axis) / e.bending + (twist / e.twisting) * s.axis;
    e.bend -= (0.25 * e.length / s.bendRate) * (toMiddle * turn);
  }
  model.setElements(std::move(loaded));
}

}  // namespace calot
