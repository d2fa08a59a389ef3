// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/bullet_peer.h"

#ifdef CALOT_BULLET

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include "tests/bench/thread_clock.h"

namespace calot::bench {

namespace {

class Solver : public btDeformableBodySolver {
 public:
  explicit Solver(const BulletBudget& budget) {
    if (budget.newtonSteps == 0) return;
    m_maxNewtonIterations = budget.newtonSteps;
    m_newtonTolerance = 0;
    m_cg.m_maxIterations = budget.iterations;
    m_cg.m_tolerance = static_cast<btScalar>(budget.tolerance);
  }
};

btVector3 bulletVector(const Vec3& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

}  // namespace

Hung hangInBullet(const HangingBody& body, int steps, const BulletBudget& budget) {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadPhase;
  Solver solver(budget);
  btDeformableMultiBodyConstraintSolver constraints;
  constraints.setDeformableSolver(&solver);
  btDeformableMultiBodyDynamicsWorld world(&dispatcher, &broadPhase, &constraints, &configuration, &solver);
  world.setImplicit(true);
  world.setLineSearch(false);
  world.setUseProjection(true);  // conjugate gradients; without it, conjugate residuals with multipliers
  world.getWorldInfo().m_sparsesdf.setDefaultVoxelsz(btScalar(0.25));
  world.getWorldInfo().m_sparsesdf.Reset();

  std::vector<btVector3> at;
  std::vector<btScalar> mass(body.node.size(), 0);
  for (const Vec3& p : body.node) at.push_back(bulletVector(p));
  for (const Index4& t : body.tetrahedron) {
    const auto corner = [&](int k) -> const Vec3& { return body.node[static_cast<std::size_t>(t[k])]; };
    const double volume = (corner(1) - corner(0)).dot((corner(2) - corner(0)).cross(corner(3) - corner(0))) / 6.0;
    for (int k = 0; k < 4; ++k)
      mass[static_cast<std::size_t>(t[k])] += static_cast<btScalar>(0.25 * volume * body.density);
  }
  for (std::size_t n = 0; n < mass.size(); ++n) mass[n] = body.fixed[n] ? btScalar(0) : mass[n];
  btSoftBody soft(&world.getWorldInfo(), static_cast<int>(at.size()), at.data(), mass.data());
  for (const Index4& t : body.tetrahedron) soft.appendTetra(t[0], t[1], t[2], t[3]);
  soft.initializeDmInverse();
  soft.m_tetraScratches.resize(soft.m_tetras.size());
  soft.m_tetraScratchesTn.resize(soft.m_tetras.size());
  soft.m_cfg.collisions = 0;
  soft.m_cfg.kDP = 0;
  soft.m_sleepingThreshold = 0;
  soft.setActivationState(DISABLE_DEACTIVATION);
  soft.setSelfCollision(false);
  world.addSoftBody(&soft, 0, 0);
  const double mu = 0.5 * body.youngModulus / (1.0 + body.poissonRatio);
  const double lambda = 2.0 * mu * body.poissonRatio / (1.0 - 2.0 * body.poissonRatio);
  btDeformableNeoHookeanForce elastic(static_cast<btScalar>(mu), static_cast<btScalar>(lambda), 0);
  btDeformableGravityForce weight(btVector3(0, 0, 0));
  world.addForce(&soft, &elastic);
  world.addForce(&soft, &weight);

  Hung hung;
  for (int n = 0; n < steps; ++n) {
    weight.m_gravity = bulletVector(body.gravity(n));
    // As a kick before the step, which implicit Euler makes the same as a force over it.
    const std::vector<Vec3> load = body.load ? body.load(n) : std::vector<Vec3>{};
    for (std::size_t k = 0; k < load.size(); ++k) {
      if (!body.fixed[k]) soft.m_nodes[static_cast<int>(k)].m_v += bulletVector(body.step / mass[k] * load[k]);
    }
    const double begin = threadSeconds();
    world.stepSimulation(static_cast<btScalar>(body.step), 0);
    hung.seconds += (threadSeconds() - begin) / steps;
  }
  for (int n = 0; n < soft.m_nodes.size(); ++n) {
    const btVector3& p = soft.m_nodes[n].m_x;
    hung.position.emplace_back(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
  }
  world.removeSoftBody(&soft);
  return hung;
}

}  // namespace calot::bench

#endif
