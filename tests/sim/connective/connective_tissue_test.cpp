// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/connective/connective_tissue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "sim/math/random.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/cube_box.h"

namespace calot {
namespace {

using test::CubeBox;
using test::cubeBox;

/// Two blocks of cubes, one above the other, joined by strands over the gap between them.
struct Pair {
  CubeBox lower = cubeBox(4, 4, 2, Vec3::Zero(), 0.01);
  CubeBox upper = cubeBox(4, 4, 2, Vec3(0.0, 0.0, 0.023), 0.01);
  SolidModel lowerSolid, upperSolid;
  ConnectiveTissue tissue;
  SolidState a, b;
  ConnectiveState state;
  PointCoupling coupling;
  SolidSolver solverA, solverB;
  std::uint32_t iterations = 0;  ///< of the last step

  static std::vector<bool> bottom(const CubeBox& box, bool hold) {
    std::vector<bool> fixed(box.node.size(), false);
    if (!hold) return fixed;
    for (int j = 0; j <= box.ny; ++j) {
      for (int i = 0; i <= box.nx; ++i) fixed[static_cast<std::size_t>(box.index(i, j, 0))] = true;
    }
    return fixed;
  }
  static MaterialPoint corner(int node) {
    MaterialPoint point;
    point.node[0] = node;
    point.weight[0] = 1.0;
    point.count = 1;
    return point;
  }
  std::vector<Strand> strands() const {
    std::vector<Strand> out;
    for (int j = 0; j <= 4; ++j) {
      for (int i = 0; i <= 4; ++i) {
        const double share = (i % 4 == 0 ? 0.5 : 1.0) * (j % 4 == 0 ? 0.5 : 1.0);
        out.push_back({corner(upper.index(i, j, 0)), corner(lower.index(i, j, 2)), 0.003, Vec3::UnitZ(), share * 1e-4});
      }
    }
    return out;
  }
  std::vector<std::array<MaterialPoint, 2>> ends() const {
    std::vector<std::array<MaterialPoint, 2>> out;
    for (const Strand& strand : tissue.strands()) out.push_back({strand.a, strand.b});
    return out;
  }
  explicit Pair(bool hold, ConnectiveMaterial material = {}, double youngModulus = 5e3)
      : lowerSolid(lower.node, lower.cube, 0.01, bottom(lower, hold),
                   {lameConstants(youngModulus, 0.4), 1000.0, 0.0, 0.02}),
        upperSolid(upper.node, upper.cube, 0.01, bottom(upper, false),
                   {lameConstants(youngModulus, 0.4), 1000.0, 0.0, 0.02}),
        tissue(strands(), {}, material),
        a(restState(upperSolid)),
        b(restState(lowerSolid)),
        state(intactState(tissue)),
        coupling(upperSolid.system(), lowerSolid.system(), ends()) {}

  /// One step of both blocks as one system. @param load per node of the upper one (N) @param springs on it
  void step(double h, std::span<const Vec3> load, std::span<const Attachment> springs = {}) {
    SerialExecutor executor;
    SolidSolver::Settings settings;
    settings.step = h;
    settings.tolerance = 1e-6;
    settings.cap = 1000;
    ConnectiveLoads loads;
    linearise(tissue, state, {a.position, a.velocity}, {b.position, b.velocity}, h, loads);
    coupling.assemble(loads.damper, h);
    loads.onA.insert(loads.onA.end(), springs.begin(), springs.end());
    solverA.assembleUnconstrained(upperSolid, a, Vec3::Zero(), load, settings, executor, {loads.onA, {}});
    solverB.assembleUnconstrained(lowerSolid, b, Vec3::Zero(), {}, settings, executor, {loads.onB, {}});
    SolidSolver* solvers[] = {&solverA, &solverB};
    const SolidSolver::Coupled coupled{0, 1, coupling};
    const SolveReport report = SolidSolver::solveJoined(solvers, {&coupled, 1}, settings);
    EXPECT_TRUE(report.converged) << report.residual;
    iterations = report.iterations;
    ASSERT_TRUE(solverA.advance(upperSolid, a, {}, h));
    ASSERT_TRUE(solverB.advance(lowerSolid, b, {}, h));
  }
  /// Impulses on the upper block's nodes, to be called after step().
  void push(double h, std::span<const Vec3> impulse) {
    SolidSolver::Settings settings;
    settings.step = h;
    settings.tolerance = 1e-6;
    settings.cap = 1000;
    solverA.takeImpulses(impulse);
    solverB.takeImpulses({});
    SolidSolver* solvers[] = {&solverA, &solverB};
    const SolidSolver::Coupled coupled{0, 1, coupling};
    EXPECT_TRUE(SolidSolver::solveJoined(solvers, {&coupled, 1}, settings).converged);
  }
  [[nodiscard]] Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t n = 0; n < a.velocity.size(); ++n) sum += upperSolid.mass()[n] * a.velocity[n];
    for (std::size_t n = 0; n < b.velocity.size(); ++n) sum += lowerSolid.mass()[n] * b.velocity[n];
    return sum;
  }
  [[nodiscard]] double speed() const {
    double speed = 0.0;
    for (const Vec3& v : a.velocity) speed = std::max(speed, v.norm());
    for (const Vec3& v : b.velocity) speed = std::max(speed, v.norm());
    return speed;
  }
};

/// A load on the upper block goes through the strands alone: at rest their pulls add up to it, exactly.
TEST(Connective, PullsBalanceTheLoadAtRest) {
  Pair pair(true);
  const Vec3 load(0.002, 0.0, 0.05);
  const std::vector<Vec3> nodal(pair.upper.node.size(), load / static_cast<double>(pair.upper.node.size()));
  for (int i = 0; i < 4000 && (i < 10 || pair.speed() > 1e-9); ++i) pair.step(0.02, nodal);
  ASSERT_LT(pair.speed(), 1e-7);
  ConnectiveLoads loads;
  linearise(pair.tissue, pair.state, {pair.a.position, pair.a.velocity}, {pair.b.position, pair.b.velocity}, 0.02,
            loads);
  Vec3 sum = Vec3::Zero();
  for (const Attachment& l : loads.onA) sum += l.force;
  EXPECT_LT((sum + load).norm(), 1e-4 * load.norm());
  double tension = 0.0;
  for (std::size_t s = 0; s < pair.tissue.strands().size(); ++s) {
    tension += strandTension(pair.tissue, pair.state, s, pair.a.position, pair.b.position);
  }
  EXPECT_NEAR(tension, load[2], 0.02 * load[2]);
}

/// Both sides see opposite forces at any place and speed.
TEST(Connective, ForcesAreOpposite) {
  Pair pair(false);
  Random random(3);
  for (Vec3& p : pair.a.position) p += 0.002 * Vec3(random.normal(), random.normal(), random.normal());
  for (double& d : pair.state.damage) d = 0.5 * random.uniform(0.0, 1.0);
  ConnectiveLoads loads;
  linearise(pair.tissue, pair.state, {pair.a.position, pair.a.velocity}, {pair.b.position, pair.b.velocity}, 0.01,
            loads);
  const std::vector<Attachment>& onA = loads.onA;
  const std::vector<Attachment>& onB = loads.onB;
  ASSERT_EQ(onA.size(), pair.tissue.strands().size());
  ASSERT_EQ(onA.size(), onB.size());
  for (std::size_t s = 0; s < onA.size(); ++s) {
    EXPECT_EQ(onA[s].damper(0, 0), loads.damper[s]);
    EXPECT_LT((onA[s].force + onB[s].force).norm(), 1e-15);
    EXPECT_EQ(onA[s].damper, onB[s].damper);
    EXPECT_GE(Vec3(onA[s].damper.diagonal()).minCoeff(), 0.0);
  }
}

/// The organs stay together and calm at any stiffness and step.
TEST(Connective, StableAtAnyStiffness) {
  for (const double stiffness : {1e3, 1e6, 1e9}) {
    for (const double h : {0.001, 0.01, 0.1}) {
      ConnectiveMaterial material;
      material.stiffness = stiffness;
      material.strength = 1e12;
      material.fractureEnergy = 1e24;
      Pair pair(true, material);
      std::vector<Vec3> nodal(pair.upper.node.size(), Vec3::Zero());
      for (int i = 0; i < 300; ++i) {
        // A hard pull in a direction that changes, then none.
        const double t = i < 100 ? 0.3 : 0.0;
        for (Vec3& f : nodal) f = t * Vec3((i / 10) % 2 == 0 ? 1.0 : -1.0, 0.3, 0.5) / 75.0;
        pair.step(h, nodal);
        for (const Vec3& p : pair.a.position) ASSERT_LT(p.norm(), 1.0) << stiffness << ' ' << h << ' ' << i;
      }
      // The soft one swings on; what is stiff has come to rest.
      if (stiffness > 1e5) {
        EXPECT_LT(pair.speed(), 0.01) << stiffness << ' ' << h;
      }
    }
  }
}

/// Two free blocks of which one flies off: what one gains the other loses, at any stiffness and step; an impulse on one
/// reaches the other within the same step.
TEST(Connective, KeepsTheMomentumOfAFreePair) {
  for (const double stiffness : {2e4, 2e5, 2e7}) {
    for (const double h : {0.001, 0.005, 0.02}) {
      ConnectiveMaterial material;
      material.stiffness = stiffness;
      material.damping = 0.0;
      material.strength = 1e9;
      material.fractureEnergy = 1e15;
      Pair pair(false, material);
      for (Vec3& v : pair.a.velocity) v = Vec3(0.01, 0.0, 0.05);
      const Vec3 before = pair.momentum();
      std::uint32_t most = 0;
      double worst = 0.0;
      for (int i = 0; i < 50; ++i) {
        pair.step(h, {});
        most = std::max(most, pair.iterations);
        worst = std::max(worst, (pair.momentum() - before).norm() / before.norm());
      }
      std::printf("K %g, h %g: momentum kept within %.1e, %u iterations\n", stiffness, h, worst, most);
      EXPECT_LT(worst, 1e-4) << stiffness << ' ' << h;
      double reached = 0.0;
      const std::vector<Vec3> start = pair.solverB.freeVelocity();
      pair.push(h, std::vector<Vec3>(pair.upper.node.size(), Vec3(0.0, 0.0, 1e-5)));
      for (std::size_t n = 0; n < start.size(); ++n) {
        reached += pair.lowerSolid.mass()[n] * (pair.solverB.freeVelocity()[n] - start[n])[2];
      }
      EXPECT_GT(reached, 0.0) << stiffness << ' ' << h;
    }
  }
}

/// Conjugate gradients over both blocks find the solution of the one system: block Gauss-Seidel between the blocks,
/// each solved with the other's velocities until nothing changes, gives the same.
TEST(Connective, TheJoinedSolutionIsThatOfTheOneSystem) {
  Pair pair(true);
  Random random(8);
  for (Vec3& v : pair.a.velocity) v = 0.05 * Vec3(random.normal(), random.normal(), random.normal());
  Pair other(true);
  other.a.velocity = pair.a.velocity;
  constexpr double h = 0.01;
  pair.step(h, {});
  SerialExecutor executor;
  SolidSolver::Settings settings;
  settings.step = h;
  settings.tolerance = 1e-7;
  settings.cap = 1000;
  ConnectiveLoads loads;
  linearise(other.tissue, other.state, {other.a.position, other.a.velocity}, {other.b.position, other.b.velocity}, h,
            loads);
  std::vector<Vec3> changeA(other.a.velocity.size(), Vec3::Zero());
  std::vector<Vec3> changeB(other.b.velocity.size(), Vec3::Zero());
  for (int sweep = 0; sweep < 60; ++sweep) {
    const auto side = [&](std::vector<Attachment> own, bool isA, const std::vector<Vec3>& theirs, SolidSolver& solver,
                          const SolidModel& model, SolidState state, std::vector<Vec3>& change) {
      for (std::size_t s = 0; s < own.size(); ++s) {
        const Strand& strand = other.tissue.strands()[s];
        own[s].force += loads.damper[s] * (isA ? strand.b : strand.a).of(theirs);
      }
      const std::vector<Vec3> before = state.velocity;
      solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor, {own, {}});
      for (std::size_t n = 0; n < change.size(); ++n) change[n] = solver.freeVelocity()[n] - before[n];
    };
    side(loads.onA, true, changeB, other.solverA, other.upperSolid, other.a, changeA);
    side(loads.onB, false, changeA, other.solverB, other.lowerSolid, other.b, changeB);
  }
  double error = 0.0;
  for (std::size_t n = 0; n < changeA.size(); ++n) {
    error = std::max(error, (pair.solverA.freeVelocity()[n] - other.solverA.freeVelocity()[n]).norm());
  }
  for (std::size_t n = 0; n < changeB.size(); ++n) {
    error = std::max(error, (pair.solverB.freeVelocity()[n] - other.solverB.freeVelocity()[n]).norm());
  }
  EXPECT_LT(error, 1e-6);  // of 0.1 m/s
}

TEST(Connective, SoftensAboveItsStrengthAndTearsAtItsFinalSeparation) {
  Pair pair(true);
  const ConnectiveMaterial& m = pair.tissue.material();
  const CohesiveLaw law = m.law();
  std::vector<std::uint32_t> torn;
  const auto openTo = [&](double separation) {
    for (std::size_t n = 0; n < pair.a.position.size(); ++n) {
      pair.a.position[n] = pair.upperSolid.rest()[n] + Vec3(0.0, 0.0, separation);
    }
    return advanceDamage(pair.tissue, pair.state, pair.a.position, pair.b.position, torn);
  };
  DamageReport report = openTo(0.99 * law.peakSeparation());
  EXPECT_NEAR(report.maxTraction, 0.99 * m.strength, 1e-9 * m.strength);
  EXPECT_FALSE(report.grown);
  const double half = 0.5 * (law.peakSeparation() + law.finalSeparation());
  report = openTo(half);
  EXPECT_TRUE(report.grown);
  EXPECT_TRUE(torn.empty());
  EXPECT_NEAR(report.maxTraction, 0.5 * m.strength, 1e-9 * m.strength);
  // Back along the secant; damage stays, and the way there does not matter.
  const std::vector<double> damage = pair.state.damage;
  report = openTo(0.25 * half);
  EXPECT_FALSE(report.grown);
  EXPECT_NEAR(report.maxTraction, 0.125 * m.strength, 1e-9 * m.strength);
  Pair steps(true);
  for (int i = 1; i <= 40; ++i) {
    for (Vec3& p : steps.a.position) p[2] += half / 40;
    advanceDamage(steps.tissue, steps.state, steps.a.position, steps.b.position, torn);
  }
  for (std::size_t s = 0; s < damage.size(); ++s) EXPECT_NEAR(steps.state.damage[s], damage[s], 1e-9);
  // A burning strand pulls less, and softens and tears at the same separations.
  pair.state.alpha[5] = 0.5;
  const double tension = strandTension(pair.tissue, pair.state, 5, pair.a.position, pair.b.position);
  EXPECT_NEAR(tension, 0.5 * 0.125 * m.strength * pair.tissue.strands()[5].area, 1e-9 * m.strength);

  pair.state.condition[3] = StrandCondition::burned;
  torn.clear();
  openTo(1.001 * law.finalSeparation());
  EXPECT_EQ(torn.size(), pair.tissue.strands().size() - 1);
  EXPECT_EQ(pair.state.condition[3], StrandCondition::burned);
  const ConnectiveShares shares = sharesOf(pair.tissue, pair.state);
  EXPECT_EQ(shares.attached, 0.0);
  EXPECT_NEAR(shares.torn + shares.burned, 1.0, 1e-12);
  ConnectiveLoads loads;
  linearise(pair.tissue, pair.state, {pair.a.position, pair.a.velocity}, {pair.b.position, pair.b.velocity}, 0.01,
            loads);
  EXPECT_TRUE(loads.onA.empty());
  EXPECT_TRUE(loads.onB.empty());
  EXPECT_EQ(loads.damper, std::vector<double>(pair.tissue.strands().size(), 0.0));
}

/// Two stiff blocks pulled apart slowly by a hand: it has to pull with the strength times the area, and its work is the
/// fracture energy times the area.
TEST(Connective, UniformOpeningTakesTheFractureEnergy) {
  for (const double h : {0.0025, 0.005, 0.01, 0.02}) {
    Pair pair(true, {}, 2e6);
    const CohesiveLaw law = pair.tissue.material().law();
    constexpr double speed = 0.005;       // m/s
    constexpr double stiffness = 1000.0;  // of the hand at each node (N/m)
    std::vector<std::uint32_t> torn;
    double work = 0.0;
    double peak = 0.0;
    double hand = 0.0;  // m
    while (hand < 1.1 * law.finalSeparation()) {
      hand += speed * h;
      std::vector<Attachment> springs;
      for (int j = 0; j <= pair.upper.ny; ++j) {
        for (int i = 0; i <= pair.upper.nx; ++i) {
          const int node = pair.upper.index(i, j, pair.upper.nz);
          const auto n = static_cast<std::size_t>(node);
          Attachment& spring = springs.emplace_back();
          spring.point = Pair::corner(node);
          spring.damper = h * stiffness * Mat3::Identity();
          spring.force = stiffness * (pair.upperSolid.rest()[n] + Vec3(0.0, 0.0, hand) - pair.a.position[n]);
        }
      }
      pair.step(h, {}, springs);
      double pull = 0.0;
      for (const Attachment& spring : springs) {
        const auto n = static_cast<std::size_t>(spring.point.node[0]);
        pull += (spring.force - spring.damper * pair.a.velocity[n])[2];
      }
      work += pull * speed * h;
      peak = std::max(peak, pull);
      advanceDamage(pair.tissue, pair.state, pair.a.position, pair.b.position, torn);
    }
    double dissipated = 0.0;
    for (std::size_t s = 0; s < pair.state.damage.size(); ++s) {
      dissipated += pair.tissue.strands()[s].area * law.dissipated(pair.state.damage[s]);
    }
    const double area = pair.tissue.area();
    std::printf("h %g: work %.4f and dissipated %.4f of G_c A, peak %.4f of sigma A\n", h,
                work / (law.fractureEnergy * area), dissipated / (law.fractureEnergy * area),
                peak / (law.strength * area));
    EXPECT_EQ(torn.size(), pair.tissue.strands().size());
    EXPECT_NEAR(work, law.fractureEnergy * area, 0.02 * law.fractureEnergy * area) << h;
    EXPECT_NEAR(dissipated, law.fractureEnergy * area, 1e-9 * law.fractureEnergy * area) << h;
    EXPECT_NEAR(peak, law.strength * area, 0.02 * law.strength * area) << h;
  }
}

/// Both organs at rest in a step of h: touches, then burns. @return number of strands touched
std::size_t burn(Pair& pair, const MovingCapsule& hook, double h, std::vector<std::uint32_t>& burned) {
  std::vector<StrandTouch> touches;
  touchStrands(pair.tissue, pair.state, {pair.a.position, pair.a.velocity}, {pair.b.position, pair.b.velocity},
               {&hook, 1}, 0.0003, h, touches);
  burnStrands(pair.tissue, pair.state, touches, h, burned);
  return touches.size();
}

/// The hook burns what it touches, in the time the material says, and nothing else; sweeping over strands between two
/// steps touches those in between.
TEST(Connective, HookBurnsWhatItSweepsOver) {
  Pair pair(true);
  const ConnectiveMaterial& m = pair.tissue.material();
  std::vector<std::uint32_t> burned;
  // Over the strands at y = 0.02, from x = -0.005 to 0.025, in the middle of the gap.
  MovingCapsule sweep;
  sweep.radius = 0.001;
  sweep.before = {Vec3(-0.005, 0.02, 0.0215), Vec3(-0.005, 0.02, 0.0216)};
  sweep.now = {Vec3(0.025, 0.02, 0.0215), Vec3(0.025, 0.02, 0.0216)};
  EXPECT_EQ(burn(pair, sweep, 0.01, burned), 3U);
  EXPECT_TRUE(burned.empty());
  // Under the wire and its reach for 2.6 mm of 30.
  const double swept = 1.0 - (1.0 - m.goneBelow) * 0.01 / m.fadeTime * 2.6 / 30.0;
  EXPECT_NEAR(pair.state.alpha[12], swept, 1e-12);
  MovingCapsule still = sweep;
  still.before = still.now = {Vec3(0.02, 0.02, 0.0215), Vec3(0.02, 0.02, 0.0216)};
  int steps = 0;
  while (burned.empty() && steps < 1000) {
    EXPECT_EQ(burn(pair, still, 0.01, burned), 1U);
    ++steps;
  }
  EXPECT_NEAR(0.01 * steps, m.fadeTime, 0.011);
  ASSERT_EQ(burned.size(), 1U);
  EXPECT_EQ(burned[0], 12U);  // i = 2, j = 2
  EXPECT_EQ(pair.state.alpha[12], 0.0);
  EXPECT_EQ(pair.state.alpha[13], 1.0);
  EXPECT_EQ(burn(pair, still, 0.01, burned), 0U);
}

/// The dose of a strand that a wire sweeps over is what it would be in steps without end: within 2 % at any step of 1
/// to 20 ms, wherever the steps begin, at every speed, while the organs move too. (It is exact but for rounding.)
TEST(Connective, DoseOfASweptStrandDoesNotDependOnTheStep) {
  const ConnectiveMaterial slow{.fadeTime = 10.0};
  for (const double speed : {0.01, 0.05, 0.3}) {
    for (const double h : {0.001, 0.0025, 0.005, 0.01, 0.02}) {
      for (const double phase : {0.0, 0.3, 0.77}) {
        Pair pair(true, slow);
        // Organs that move along the wire's way by a fifth of its speed.
        const Vec3 drift(0.2 * speed, 0.0, 0.0);
        const auto motion = [&](double t, SolidState& organ, const SolidModel& solid) {
          organ.position = solid.rest();
          for (Vec3& p : organ.position) p += t * drift;
          organ.velocity.assign(organ.position.size(), drift);
        };
        std::vector<std::uint32_t> burned;
        for (double t = -phase * h; speed * t < 0.05; t += h) {
          const auto at = [&](double when) { return Vec3(-0.01 + speed * when, 0.02, 0.0215); };
          motion(t + h, pair.a, pair.upperSolid);
          motion(t + h, pair.b, pair.lowerSolid);
          const MovingCapsule wire{
              {at(t), at(t) + Vec3(0.0, 0.0003, 0.0)}, {at(t + h), at(t + h) + Vec3(0.0, 0.0003, 0.0)}, 0.0006};
          burn(pair, wire, h, burned);
        }
        const double expected = 2.0 * 0.0009 / (0.8 * speed);
        const double dose = (1.0 - pair.state.alpha[12]) / (1.0 - slow.goneBelow) * slow.fadeTime;
        EXPECT_NEAR(dose, expected, 1e-6 * expected) << speed << " m/s, steps of " << h << " s, phase " << phase;
      }
    }
  }
}

/// Residue: a torn strand is no longer in the way between the organs, but burns at either of them.
TEST(Connective, ResidueBurnsAtItsStumps) {
  Pair pair(true);
  pair.state.condition[12] = StrandCondition::torn;
  for (Vec3& p : pair.a.position) p[2] += 0.03;
  std::vector<std::uint32_t> burned;
  MovingCapsule hook;
  hook.radius = 0.001;
  hook.before = hook.now = {Vec3(0.02, 0.02, 0.038), Vec3(0.02, 0.02, 0.038)};  // between the organs
  EXPECT_EQ(burn(pair, hook, 0.01, burned), 0U);
  hook.before = hook.now = {Vec3(0.02, 0.02, 0.052), Vec3(0.02, 0.02, 0.052)};  // at the upper one
  for (int i = 0; i < 100; ++i) burn(pair, hook, 0.01, burned);
  ASSERT_EQ(burned.size(), 1U);
  EXPECT_EQ(burned[0], 12U);
  EXPECT_EQ(sharesOf(pair.tissue, pair.state).torn, 0.0);
}

TetrahedralMesh tetrahedra(const CubeBox& box) {
  TetrahedralMesh mesh;
  mesh.vertex = box.node;
  constexpr int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (const Index8& cube : box.cube) {
    for (const auto& axes : order) {
      int at = 0;
      Index4 t(cube[0], 0, 0, 0);
      for (int s = 0; s < 3; ++s) {
        at |= 1 << axes[s];
        t[s + 1] = cube[static_cast<std::size_t>(at)];
      }
      const auto p = [&](int c) { return mesh.vertex[static_cast<std::size_t>(t[c])]; };
      if ((p(1) - p(0)).cross(p(2) - p(0)).dot(p(3) - p(0)) < 0.0) std::swap(t[2], t[3]);
      mesh.tetrahedron.push_back(t);
    }
  }
  return mesh;
}

/// A block on a block: the bed is the face between them, whatever the division.
TEST(ConnectiveBed, CoversTheFaceBetweenTwoBlocks) {
  const TetrahedralMesh below = tetrahedra(cubeBox(6, 6, 2, Vec3(-0.01, -0.01, 0.0), 0.01));
  const TetrahedralMesh above = tetrahedra(cubeBox(4, 4, 2, Vec3(0.0, 0.0, 0.022), 0.01));
  const TriangleMesh skinBelow = boundarySurface(below);
  const TriangleMesh skinAbove = boundarySurface(above);
  for (const std::size_t least : {10U, 200U, 700U}) {
    const ConnectiveBed bed = makeBed({skinAbove, above}, {skinBelow, below}, 0.004, least);
    ASSERT_TRUE(bed.ok()) << bed.error;
    EXPECT_GE(bed.strands.size(), least);
    double area = 0.0;
    for (const Strand& s : bed.strands) {
      area += s.area;
      const Vec3 a = s.a.of(above.vertex);
      const Vec3 b = s.b.of(below.vertex);
      EXPECT_NEAR(a[2], 0.022, 1e-9);
      EXPECT_NEAR(b[2], 0.020, 1e-9);
      EXPECT_NEAR(s.restLength, 0.002, 1e-9);
      EXPECT_LT((s.restDirection - Vec3::UnitZ()).norm(), 1e-6);
      EXPECT_LT((a - b - Vec3(0.0, 0.0, 0.002)).norm(), 1e-9);
    }
    EXPECT_NEAR(area, 16e-4, 1e-9);
    // Euler: vertices - edges + triangles = 1 for a disc; triangles follow from edges and boundary.
    for (const auto& [i, j] : bed.sheets) {
      EXPECT_LT(i, j);
      EXPECT_LT(j, bed.strands.size());
    }
  }
  EXPECT_FALSE(makeBed({skinAbove, above}, {skinBelow, below}, 0.001, 10).ok());
}

/// The same tissue in more strands pulls alike.
TEST(ConnectiveBed, DivisionDoesNotChangeTheTissue) {
  const TetrahedralMesh below = tetrahedra(cubeBox(6, 6, 2, Vec3(-0.01, -0.01, 0.0), 0.01));
  const TetrahedralMesh above = tetrahedra(cubeBox(4, 4, 2, Vec3(0.0, 0.0, 0.022), 0.01));
  const TriangleMesh skinBelow = boundarySurface(below);
  const TriangleMesh skinAbove = boundarySurface(above);
  double first = 0.0;
  for (const std::size_t least : {25U, 600U}) {
    const ConnectiveBed bed = makeBed({skinAbove, above}, {skinBelow, below}, 0.004, least);
    const ConnectiveTissue tissue(bed.strands, bed.sheets, {});
    const ConnectiveState state = intactState(tissue);
    std::vector<Vec3> lifted = above.vertex;
    for (Vec3& p : lifted) p += Vec3(0.001, 0.0, 0.002);
    const std::vector<Vec3> stillA(above.vertex.size(), Vec3::Zero());
    const std::vector<Vec3> stillB(below.vertex.size(), Vec3::Zero());
    ConnectiveLoads loads;
    linearise(tissue, state, {lifted, stillA}, {below.vertex, stillB}, 0.01, loads);
    Vec3 sum = Vec3::Zero();
    for (const Attachment& l : loads.onA) sum += l.force;
    if (first == 0.0) {
      first = sum[2];
    } else {
      EXPECT_NEAR(sum[2], first, 1e-9 * std::abs(first));
    }
  }
  EXPECT_LT(first, -0.1);
}

}  // namespace
}  // namespace calot
