// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/vessel/beam_model.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/math/linear.h"
#include "sim/vessel/beam_state.h"

namespace calot {

namespace {

double innerRadius(const TubeSection& s) { return s.wall >= s.outerRadius ? 0.0 : s.outerRadius - s.wall; }

/// Direction of the centre line at each node: the mean of its chords' directions.
std::vector<Vec3> tangentsOf(const std::vector<Vec3>& node) {
  std::vector<Vec3> chord;
  for (std::size_t i = 0; i + 1 < node.size(); ++i) {
    const Vec3 d = node[i + 1] - node[i];
    chord.push_back(d / d.norm());
  }
  std::vector<Vec3> tangent{chord.front()};
  for (std::size_t i = 0; i + 1 < chord.size(); ++i) {
    const Vec3 sum = chord[i] + chord[i + 1];
    tangent.push_back(sum / sum.norm());
  }
  tangent.push_back(chord.back());
  return tangent;
}

/// A point of the uniform Catmull-Rom curve: t in [0, 1] between points i and i + 1.
Vec3 curvePoint(std::span<const Vec3> p, std::size_t i, double t) {
  const Vec3 before = i > 0 ? p[i - 1] : Vec3(2.0 * p[i] - p[i + 1]);
  const Vec3 after = i + 2 < p.size() ? p[i + 2] : Vec3(2.0 * p[i + 1] - p[i]);
  const Vec3 m0 = 0.5 * (p[i + 1] - before);
  const Vec3 m1 = 0.5 * (after - p[i]);
  const double t2 = t * t;
  const double t3 = t2 * t;
  return (2.0 * t3 - 3.0 * t2 + 1.0) * p[i] + (t3 - 2.0 * t2 + t) * m0 + (3.0 * t2 - 2.0 * t3) * p[i + 1] +
         (t3 - t2) * m1;
}

}  // namespace

double TubeSection::area() const {
  const double inner = innerRadius(*this);
  return std::numbers::pi * (outerRadius * outerRadius - inner * inner);
}

double TubeSection::secondMoment() const {
  const double o = outerRadius * outerRadius;
  const double i = innerRadius(*this) * innerRadius(*this);
  return 0.25 * std::numbers::pi * (o * o - i * i);
}

std::vector<Vec3> evenNodes(std::span<const Vec3> points, std::size_t elements) {
  assert(points.size() >= 2 && elements >= 1);
  constexpr std::size_t pieces = 64;
  std::vector<Vec3> fine{points[0]};
  std::vector<double> length{0.0};
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    for (std::size_t k = 1; k <= pieces; ++k) {
      fine.push_back(curvePoint(points, i, static_cast<double>(k) / static_cast<double>(pieces)));
      length.push_back(length.back() + (fine.back() - fine[fine.size() - 2]).norm());
    }
  }
  std::vector<Vec3> out{points.front()};
  std::size_t at = 0;
  for (std::size_t n = 1; n < elements; ++n) {
    const double wanted = length.back() * static_cast<double>(n) / static_cast<double>(elements);
    while (length[at + 1] < wanted) ++at;
    const double t = (wanted - length[at]) / (length[at + 1] - length[at]);
    out.push_back((1.0 - t) * fine[at] + t * fine[at + 1]);
  }
  out.push_back(points.back());
  return out;
}

std::string BeamModel::faultOf(const std::vector<BeamBranch>& branches) {
  std::size_t nodes = 0;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const BeamBranch& branch = branches[b];
    const BeamMaterial& m = branch.material;
    const std::string name = "branch " + std::to_string(b) + ": ";
    if (branch.node.size() < 2) return name + "fewer than two nodes";
    for (std::size_t i = 0; i < branch.node.size(); ++i) {
      if (!branch.node[i].allFinite()) return name + "node " + std::to_string(i) + " is not finite";
      if (i > 0 && !((branch.node[i] - branch.node[i - 1]).norm() > 1e-9)) {
        return name + "nodes " + std::to_string(i - 1) + " and " + std::to_string(i) + " coincide";
      }
      if (i > 1) {
        const Vec3 before = branch.node[i - 1] - branch.node[i - 2];
        const Vec3 after = branch.node[i] - branch.node[i - 1];
        if (!(before.dot(after) > 0.0)) return name + "folds back at node " + std::to_string(i - 1);
      }
    }
    if (!(branch.section.outerRadius > 0.0)) return name + "outer radius must be above 0";
    if (!(branch.section.wall > 0.0)) return name + "wall must be above 0";
    if (!(m.young > 0.0)) return name + "Young's modulus must be above 0";
    if (!(m.poisson > -1.0 && m.poisson < 0.5)) return name + "Poisson's ratio must be above -1 and below 0.5";
    if (!(m.density > 0.0)) return name + "density must be above 0";
    if (!(m.massDamping >= 0.0 && m.stiffnessDamping >= 0.0)) return name + "damping must be 0 or more";
    if (!(m.ultimateStrain > 0.0)) return name + "ultimate strain must be above 0";
    if (branch.join >= static_cast<int>(nodes)) return name + "joins a node that no earlier branch has";
    nodes += branch.node.size() - (branch.join >= 0 ? 1 : 0);
  }
  return branches.empty() ? "no branches" : "";
}

void BeamModel::addNode(const Vec3& position, const Quat& orientation, int parent, bool fixed) {
  rest_.push_back(position);
  restOrientation_.push_back(orientation);
  parent_.push_back(parent);
  elementBefore_.push_back(-1);
  fixed_.push_back(fixed);
  mass_.push_back(0.0);
  inertia_.push_back(0.0);
  massDamping_.push_back(0.0);
}

BeamModel::BeamModel(const std::vector<BeamBranch>& branches) {
  assert(faultOf(branches).empty());
  for (std::size_t b = 0; b < branches.size(); ++b) {
    const BeamBranch& from = branches[b];
    Branch branch;
    branch.section = from.section;
    branch.material = from.material;
    branch.join = from.join;
    branch.firstElement = element_.size();
    std::vector<Vec3> node = from.node;
    if (from.join >= 0) node[0] = rest_[static_cast<std::size_t>(from.join)];
    const std::vector<Vec3> tangent = tangentsOf(node);
    Quat frame;
    if (from.join >= 0) {
      const Quat& joined = restOrientation_[static_cast<std::size_t>(from.join)];
      frame = normalised(minimalRotation(joined * Vec3::UnitZ(), tangent[0]) * joined);
      branch.startFrame = normalised(joined.conjugate() * frame);
      branch.node.push_back(from.join);
      if (from.fixedStart) fixed_[static_cast<std::size_t>(from.join)] = true;
    } else {
      frame = frameAlong(tangent[0]);
      branch.node.push_back(static_cast<int>(rest_.size()));
      addNode(node[0], frame, -1, from.fixedStart);
    }
    branch.arcLength.push_back(0.0);
    const double area = from.section.area();
    const double second = from.section.secondMoment();
    const BeamMaterial& m = from.material;
    for (std::size_t i = 1; i < node.size(); ++i) {
      frame = normalised(minimalRotation(tangent[i - 1], tangent[i]) * frame);
      BeamElement e;
      e.a = branch.node.back();
      e.b = static_cast<int>(rest_.size());
      e.branch = static_cast<int>(b);
      addNode(node[i], frame, e.a, from.fixedEnd && i + 1 == node.size());
      elementBefore_.back() = static_cast<int>(element_.size());
      branch.node.push_back(e.b);
      const Quat& qa = restOrientation_[static_cast<std::size_t>(e.a)];
      const Mat3 middle = blend(qa, frame, 0.5).toRotationMatrix();
      const Vec3 d = node[i] - node[i - 1];
      e.length = d.norm();
      e.axis = middle.transpose() * (d / e.length);
      e.slack = e.axis;
      e.bend = middle.transpose() * quarterTangent(qa, frame);
      e.stretching = m.young * area;
      e.bending = m.young * second;
      e.twisting = m.young / (1.0 + m.poisson) * second;
      e.damping = m.stiffnessDamping;
      branch.arcLength.push_back(branch.arcLength.back() + e.length);
      for (const int end : {e.a, e.b}) {
        const auto n = static_cast<std::size_t>(end);
        const double half = 0.5 * m.density * area * e.length;
        massDamping_[n] = (massDamping_[n] * mass_[n] + m.massDamping * half) / (mass_[n] + half);
        mass_[n] += half;
        inertia_[n] += m.density * second * e.length;
      }
      element_.push_back(e);
    }
    branch.firstStation = branch_.empty() ? 0 : stations();
    branch.stations = static_cast<std::size_t>(std::ceil(branch.length() / maxSpacing));
    branch_.push_back(branch);
  }
}

std::vector<double> BeamModel::junctions(std::size_t branch) const {
  const Branch& own = branch_[branch];
  std::vector<double> out;
  if (own.join >= 0) out.push_back(0.0);
  for (std::size_t other = 0; other < branch_.size(); ++other) {
    if (other == branch || branch_[other].join < 0) continue;
    for (std::size_t i = 0; i < own.node.size(); ++i) {
      if (own.node[i] == branch_[other].join) out.push_back(own.arcLength[i]);
    }
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

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
