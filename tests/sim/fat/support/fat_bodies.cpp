// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/fat/support/fat_bodies.h"

#include <gtest/gtest.h>

#include <cmath>

#include "sim/math/fields.h"
#include "sim/solid/elements.h"

namespace calot::test {

TriangleMesh lumpSurface(const Vec3& halfAxes, double wave) {
  constexpr int rings = 40;
  constexpr int sectors = 80;
  constexpr double pi = 3.14159265358979323846;
  TriangleMesh mesh;
  const auto add = [&](const Vec3& d) {
    const double size = 1.0 + wave * std::sin(9.0 * d[0] + 1.0) * std::cos(8.0 * d[1]);
    mesh.vertex.emplace_back(size * halfAxes.cwiseProduct(d));
  };
  add(Vec3::UnitZ());
  for (int j = 1; j < rings; ++j) {
    for (int i = 0; i < sectors; ++i) {
      const double a = pi * j / rings;
      const double b = 2.0 * pi * i / sectors;
      add({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
  }
  add(-Vec3::UnitZ());
  const int last = mesh.vertices() - 1;
  const auto at = [](int j, int i) { return 1 + (j - 1) * sectors + i % sectors; };
  for (int i = 0; i < sectors; ++i) {
    mesh.triangle.emplace_back(0, at(1, i), at(1, i + 1));
    mesh.triangle.emplace_back(last, at(rings - 1, i + 1), at(rings - 1, i));
    for (int j = 1; j + 1 < rings; ++j) {
      mesh.triangle.emplace_back(at(j, i), at(j + 1, i), at(j + 1, i + 1));
      mesh.triangle.emplace_back(at(j, i), at(j + 1, i + 1), at(j, i + 1));
    }
  }
  return mesh;
}

TriangleMesh boxSurface(const Vec3& half) {
  TriangleMesh mesh;
  for (int c = 0; c < 8; ++c) {
    mesh.vertex.emplace_back(half.cwiseProduct(Vec3((c & 1) * 2 - 1, (c >> 1 & 1) * 2 - 1, (c >> 2) * 2 - 1)));
  }
  for (const std::array<int, 4> q :
       {std::array<int, 4>{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}) {
    mesh.triangle.emplace_back(q[0], q[1], q[2]);
    mesh.triangle.emplace_back(q[0], q[2], q[3]);
  }
  return mesh;
}

FatSettings fatSettings(double cell, int cellsPerCube) {
  FatSettings settings;
  settings.cell = cell;
  settings.cellsPerCube = cellsPerCube;
  settings.material.lame = lameConstants(1000.0, 0.4);
  settings.material.density = 920.0;
  settings.material.massDamping = 2.0;
  settings.material.stiffnessDamping = 0.01;
  return settings;
}

FatPartner floorPartner(double height) {
  FatPartner partner;
  partner.name = "floor";
  partner.distance = [height](const Vec3& p) { return p[2] - height; };
  partner.reach = 0.0;
  return partner;
}

std::unique_ptr<const FatModel> fatOn(const TriangleMesh& surface, const FatSettings& settings,
                                      std::vector<FatPartner> partners, std::vector<FatRegion> regions) {
  std::string error;
  std::unique_ptr<const FatModel> model = FatModel::make(surface, settings, partners, regions, error);
  EXPECT_EQ(error, "");
  return model;
}

FatRig::FatRig(const FatModel& m) : model(m), body(m), state(restState(m)) { settings.tolerance = 1e-6; }

void FatRig::move(const Vec3& gravity, std::span<const Vec3> force, const Vec3& shift) {
  std::vector<Attachment> attachments;
  for (std::size_t t = 0; t < model.allTies().size(); ++t) {
    const FatTie& tie = model.allTies()[t];
    const double share = body.tieShare(t);
    if (share == 0.0) continue;
    Attachment& a = attachments.emplace_back();
    a.point = tie.point;
    a.damper = share * (settings.step * tie.stiffness + tie.damping) * Mat3::Identity();
    a.force = share * tie.stiffness * (tie.rest + shift - tie.point.of(state.solid.position));
  }
  body.beginStep(state);
  const SolveReport report = solver.solveUnconstrained(model.solid(), state.solid, gravity, force, settings, executor,
                                                       {attachments, body.fill()});
  EXPECT_TRUE(report.converged);
  EXPECT_TRUE(solver.advance(model.solid(), state.solid, {}, settings.step));
}

void FatRig::tieForces(Vec3& force, Vec3& moment) const {
  force.setZero();
  moment.setZero();
  for (std::size_t t = 0; t < model.allTies().size(); ++t) {
    const FatTie& tie = model.allTies()[t];
    const Vec3 x = tie.point.of(state.solid.position);
    const Vec3 f = body.tieShare(t) * tie.stiffness * (tie.rest - x);
    force += f;
    moment += x.cross(f);
  }
}

double FatRig::mass() const {
  const double edge = model.lattice().cell() * model.cellsPerCube();
  double sum = 0.0;
  for (const double share : body.fill()) sum += share * model.solid().material().density * edge * edge * edge;
  return sum;
}

std::vector<std::byte> bytesOfState(const FatState& state) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  writer.write(state.solid);
  writer.write(state.carved);
  return bytes;
}

SweptCapsule randomSweep(Random& random, const Box& box, double radius, double segment, double length) {
  const auto direction = [&random] {
    const double x = random.normal();
    const double y = random.normal();
    const double z = random.normal();
    return Vec3(Vec3(x, y, z).normalized());
  };
  SweptCapsule c;
  c.radius = radius;
  for (int a = 0; a < 3; ++a) c.p0[a] = random.uniform(box.lower[a], box.upper[a]);
  c.p1 = c.p0 + segment * direction();
  c.q0 = c.p0 + length * direction();
  c.q1 = c.q0 + segment * direction();
  return c;
}

SweptCapsule placed(const SweptCapsule& c, const Pose& pose) {
  SweptCapsule out = c;
  for (Vec3* p : {&out.p0, &out.p1, &out.q0, &out.q1}) *p = pose.position + pose.orientation * *p;
  return out;
}

}  // namespace calot::test
