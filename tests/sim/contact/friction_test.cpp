// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid block on a slope, stepped through the contact solver alone: Coulomb's law as every textbook has it.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "tests/sim/contact/support/contact_reference.h"

namespace calot {
namespace {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// A cuboid that stands on a plane with its four lower corners, more contacts than a rigid body can tell apart. Frame:
/// x down the slope, z out of it, gravity turned by the slope's angle.
class BlockOnSlope {
 public:
  static constexpr double mass = 0.2;            // kg
  static constexpr double gravity = 9.81;        // m/s^2
  static constexpr double step = 0.01;           // s
  const Eigen::Vector3d half{0.03, 0.02, 0.01};  // m

  BlockOnSlope(double slope, double mu) {
    weight_ = mass * gravity * Eigen::Vector3d(std::sin(slope), 0.0, -std::cos(slope));
    inverse_.head<3>().setConstant(1.0 / mass);
    for (int a = 0; a < 3; ++a) {
      const double b = half[(a + 1) % 3];
      const double c = half[(a + 2) % 3];
      inverse_[3 + a] = 3.0 / (mass * (b * b + c * c));
    }
    problem_.kind.assign(4, BlockKind::frictional);
    problem_.limit.assign(4, mu);
    rows_.resize(12, 6);
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3d r((corner % 2 == 0 ? -1.0 : 1.0) * half[0], (corner / 2 == 0 ? -1.0 : 1.0) * half[1],
                              -half[2]);
      const std::array<Eigen::Vector3d, 3> direction{Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(),
                                                     Eigen::Vector3d::UnitY()};
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d& d = direction[static_cast<std::size_t>(k)];
        rows_.row(3 * corner + k) << d.transpose(), r.cross(d).transpose();
      }
    }
    problem_.w = step * step * rows_ * inverse_.asDiagonal() * rows_.transpose();
    force_.assign(12, 0.0);
    gap_.assign(12, 0.0);
  }

  /// Small angles: the rows stay as they are. @returns the residual
  double advance() {
    Vec6 velocity = velocity_;
    velocity.head<3>() += step / mass * weight_;
    problem_.free = step * rows_ * velocity;
    for (int corner = 0; corner < 4; ++corner) problem_.free[3 * corner] += height_[static_cast<std::size_t>(corner)];
    const ContactReport report = solver_.solve(problem_.view(), force_, gap_, 1e-13, 2000);
    const Eigen::Map<const Eigen::VectorXd> force(force_.data(), 12);
    velocity_ = velocity + step * inverse_.asDiagonal() * rows_.transpose() * force;
    travelled_ += step * velocity_[0];
    for (std::size_t corner = 0; corner < 4; ++corner) height_[corner] = gap_[3 * corner];
    return report.residual;
  }

  [[nodiscard]] double travelled() const { return travelled_; }
  [[nodiscard]] const Vec6& velocity() const { return velocity_; }
  /// Sum of the contact forces (N).
  [[nodiscard]] Eigen::Vector3d support() const {
    const Eigen::Map<const Eigen::VectorXd> force(force_.data(), 12);
    return (rows_.transpose() * force).head<3>();
  }

 private:
  Eigen::Vector3d weight_;
  Vec6 inverse_, velocity_ = Vec6::Zero();
  Eigen::MatrixXd rows_;
  test::OwnedProblem problem_;
  std::vector<double> force_, gap_;
  std::array<double, 4> height_{};
  double travelled_ = 0.0;
  ContactSolver solver_;
};

TEST(Friction, ABlockStaysOnASlopeBelowTheFrictionAngle) {
  for (const double mu : {0.1, 0.4, 0.8}) {
    const double angle = 0.99 * std::atan(mu);
    BlockOnSlope block(angle, mu);
    double worst = 0.0;
    for (int i = 0; i < 100; ++i) worst = std::max(worst, block.advance());
    EXPECT_LE(worst, 1e-13);
    EXPECT_LT(std::abs(block.travelled()), 1e-9) << "m in one second, mu " << mu;
    const double weight = BlockOnSlope::mass * BlockOnSlope::gravity;
    EXPECT_NEAR(block.support()[2], weight * std::cos(angle), 1e-6 * weight);
    EXPECT_NEAR(block.support()[0], -weight * std::sin(angle), 1e-6 * weight);
  }
}

TEST(Friction, ABlockSlidesAboveTheFrictionAngle) {
  for (const double mu : {0.0, 0.1, 0.4, 0.8}) {
    const double angle = 1.01 * std::atan(mu) + 0.01;
    BlockOnSlope block(angle, mu);
    for (int i = 0; i < 100; ++i) EXPECT_LE(block.advance(), 1e-13);
    const double acceleration = BlockOnSlope::gravity * (std::sin(angle) - mu * std::cos(angle));
    EXPECT_NEAR(block.velocity()[0], acceleration * 1.0, 1e-6 * acceleration) << "m/s after one second, mu " << mu;
    EXPECT_LT(block.velocity().segment<2>(1).norm(), 1e-8);
    EXPECT_LT(block.velocity().tail<3>().norm(), 1e-5) << "it does not tip";
    const Eigen::Vector3d support = block.support();
    EXPECT_NEAR(-support[0] / support[2], mu, 1e-6) << "the force is on the cone";
  }
}

/// The angle at which it begins to slide, by halving: arctan(mu).
TEST(Friction, TheFrictionAngleIsTheArctangentOfMu) {
  for (const double mu : {0.15, 0.5}) {
    double stays = 0.0;
    double slides = 1.2;
    while (slides - stays > 1e-4) {
      const double angle = 0.5 * (stays + slides);
      BlockOnSlope block(angle, mu);
      for (int i = 0; i < 50; ++i) block.advance();
      (block.travelled() > 1e-7 ? slides : stays) = angle;
    }
    EXPECT_NEAR(slides, std::atan(mu), 3e-4);
    std::printf("mu %.2f: slides from %.3f degrees, arctan %.3f\n", mu, slides * 180.0 / std::numbers::pi,
                std::atan(mu) * 180.0 / std::numbers::pi);
  }
}

}  // namespace
}  // namespace calot
