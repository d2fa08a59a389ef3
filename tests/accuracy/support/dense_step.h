// SPDX-License-Identifier: GPL-3.0-or-later
// One step of a scene once more, over dense matrices in double: co-rotational elements with exact polar rotations,
// implicit Euler by a direct factorisation, the compliance of contact by direct solves. Detection is the product's own
// (it has tests of its own); no other code is shared.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <Eigen/Dense>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/instruments/instrument_shape.h"
#include "sim/step/stepper.h"
#include "tests/sim/contact/support/contact_reference.h"

namespace calot::test {

/// The organ's system of implicit Euler at a state, factorised.
class DenseOrgan {
 public:
  DenseOrgan(const SolidModel& model, const SolidState& state, const Vec3& gravity, double h) : nodes_(model.nodes()) {
    const SolidModel::Material& m = model.material();
    const auto size = static_cast<Eigen::Index>(3 * nodes_);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(size);
    for (const Index4& t : model.tetrahedra()) {
      Mat3 rest;
      Mat3 now;
      for (int c = 0; c < 3; ++c) {
        rest.col(c) = at(model.rest(), t[c + 1]) - at(model.rest(), t[0]);
        now.col(c) = at(state.position, t[c + 1]) - at(state.position, t[0]);
      }
      const double volume = rest.determinant() / 6.0;
      const Mat3 inverse = rest.inverse();
      Eigen::Matrix<double, 3, 4> gradient;
      gradient.rightCols<3>() = inverse.transpose();
      gradient.col(0) = -gradient.rightCols<3>().rowwise().sum();
      const Eigen::JacobiSVD<Mat3> svd(now * inverse, Eigen::ComputeFullU | Eigen::ComputeFullV);
      const Mat3 r = svd.matrixU() * svd.matrixV().transpose();
      Mat3 f = Mat3::Zero();
      for (int c = 0; c < 4; ++c) {
        const Vec3 ahead = at(state.position, t[c]) + (h + m.stiffnessDamping) * at(state.velocity, t[c]);
        f += ahead * gradient.col(c).transpose();
      }
      const Mat3 turned = r.transpose() * f;
      const Mat3 strain = 0.5 * (turned + turned.transpose()) - Mat3::Identity();
      const Mat3 stress = 2.0 * m.lame.mu * strain + m.lame.lambda * strain.trace() * Mat3::Identity();
      for (int i = 0; i < 4; ++i) {
        b.segment<3>(3 * t[i]) -= h * volume * (r * stress * gradient.col(i));
        for (int j = 0; j < 4; ++j) {
          const Vec3 gi = r * gradient.col(i);
          const Vec3 gj = r * gradient.col(j);
          const Mat3 k = volume * (m.lame.lambda * gi * gj.transpose() + m.lame.mu * gj * gi.transpose() +
                                   m.lame.mu * gi.dot(gj) * Mat3::Identity());
          a.block<3, 3>(3 * t[i], 3 * t[j]) += (h * h + m.stiffnessDamping * h) * k;
        }
      }
      for (int i = 0; i < 4; ++i) {
        const double quarter = 0.25 * m.density * volume;
        a.block<3, 3>(3 * t[i], 3 * t[i]).diagonal().array() += (1.0 + m.massDamping * h) * quarter;
        b.segment<3>(3 * t[i]) += h * quarter * (gravity - m.massDamping * at(state.velocity, t[i]));
      }
    }
    for (std::size_t n = 0; n < nodes_; ++n) {
      if (model.row(n) >= 0) continue;
      for (Eigen::Index k = static_cast<Eigen::Index>(3 * n); k < static_cast<Eigen::Index>(3 * n + 3); ++k) {
        a.row(k).setZero();
        a.col(k).setZero();
        a(k, k) = 1.0;
        b[k] = 0.0;
        fixed_.push_back(k);
      }
    }
    factor_.compute(a);
    velocity_ = factor_.solve(b);
    for (std::size_t n = 0; n < nodes_; ++n) {
      velocity_.segment<3>(static_cast<Eigen::Index>(3 * n)) += state.velocity[n];
    }
  }

  [[nodiscard]] const Eigen::VectorXd& freeVelocity() const { return velocity_; }
  /// Velocity of all nodes for impulses on them.
  [[nodiscard]] Eigen::VectorXd response(Eigen::VectorXd impulse) const {
    for (const Eigen::Index k : fixed_) impulse[k] = 0.0;
    return factor_.solve(impulse);
  }
  [[nodiscard]] std::size_t nodes() const { return nodes_; }

 private:
  static const Vec3& at(const std::vector<Vec3>& values, int node) { return values[static_cast<std::size_t>(node)]; }
  std::size_t nodes_;
  std::vector<Eigen::Index> fixed_;
  Eigen::LDLT<Eigen::MatrixXd> factor_;
  Eigen::VectorXd velocity_;
};

/// The contact problem of one hand on one organ, posed densely.
struct DenseContact {
  OwnedProblem problem;
  std::vector<ToolRow> tool;  ///< per row
};

/// @param before the organ at the step's beginning @param reference simulated tool at detection @param real the hand's
/// @param published tells which of the places that were found took part: those with these rows
inline DenseContact denseContact(const Model& model, std::size_t hand, const SolidState& before, const Pose& reference,
                                 const Pose& real, double jaw, double reach, const ContactSet& published) {
  const OrganModel& organ = model.organs()[0];
  const OrganDescription& description = model.scene().organs[0];
  const HandDescription& h = model.scene().hands[hand];
  const double step = model.stepSeconds();
  const DenseOrgan dense(organ.solid, before, model.scene().gravity, step);
  std::vector<Vec3> skin;
  organ.embedding.map(before.position, skin);
  std::vector<std::uint32_t> all(organ.surface.patches().size());
  for (std::uint32_t p = 0; p < all.size(); ++p) all[p] = p;
  const InstrumentShape shape =
      placed(instrumentShape(h.instrument, jaw, h.shaftRadius, (reference.position - h.port).norm()), reference);
  std::vector<SurfaceContact> found;
  for (const Capsule& c : shape.capsules()) {
    capsuleContacts(organ.surface, skin, all, c.p0, c.p1, c.radius, reach, c.piece, found);
  }
  ToolRow stretch;
  stretch.head<3>() = real.position - reference.position;
  stretch[3] = rollBetween(reference.orientation, real.orientation);
  const bool frictional = description.friction > 0.0;
  std::vector<Eigen::VectorXd> push;
  DenseContact out;
  std::vector<double> free;
  for (const SurfaceContact& contact : found) {
    const ToolRow along = toolRow(h.port, reference, contact.onAxis, contact.normal);
    const auto same = [&](const ToolRow& row) { return (row - along).norm() < 1e-12; };
    if (std::none_of(published.direction.begin(), published.direction.end(), same)) continue;
    if (std::any_of(out.tool.begin(), out.tool.end(), same)) continue;  // the same place of two pieces
    const Vec3 x = contact.normal.cross(std::abs(contact.normal[0]) < 0.7 ? Vec3::UnitX() : Vec3::UnitY()).normalized();
    const std::array<Vec3, 3> direction{contact.normal, x, contact.normal.cross(x)};
    out.problem.kind.push_back(frictional ? BlockKind::frictional : BlockKind::unilateral);
    out.problem.limit.push_back(description.friction);
    for (std::size_t k = 0; k < (frictional ? 3U : 1U); ++k) {
      Eigen::VectorXd p = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * dense.nodes()));
      for (std::size_t c = 0; c < 3; ++c) {
        const Embedding::Anchor& anchor = organ.embedding.anchors()[static_cast<std::size_t>(contact.node[c])];
        for (std::size_t i = 0; i < 4; ++i) {
          p.segment<3>(3 * anchor.node[i]) -= contact.weight[static_cast<int>(c)] * anchor.weight[i] * direction[k];
        }
      }
      out.tool.push_back(toolRow(h.port, reference, contact.onAxis, direction[k]));
      free.push_back((k == 0 ? contact.gap : 0.0) + step * p.dot(dense.freeVelocity()) + out.tool.back().dot(stretch));
      push.push_back(p);
    }
  }
  const auto n = static_cast<Eigen::Index>(push.size());
  out.problem.free = Eigen::Map<const Eigen::VectorXd>(free.data(), n);
  out.problem.w.resize(n, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::VectorXd answer = dense.response(push[static_cast<std::size_t>(j)]);
    const ToolRow& tj = out.tool[static_cast<std::size_t>(j)];
    for (Eigen::Index i = 0; i < n; ++i) {
      const ToolRow& ti = out.tool[static_cast<std::size_t>(i)];
      out.problem.w(i, j) = step * step * push[static_cast<std::size_t>(i)].dot(answer) +
                            ti.head<3>().dot(tj.head<3>()) / h.couplingStiffness + ti[3] * tj[3] / h.rollStiffness;
    }
  }
  return out;
}

}  // namespace calot::test
