// SPDX-License-Identifier: GPL-3.0-or-later
// What a step works with, and its parts in the order in which they run. Internal to this folder.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/contact/shaft_contact.h"
#include "sim/instruments/shaft.h"
#include "sim/scene/stepper.h"

namespace calot {

namespace stepping {
inline constexpr double margin = 0.001;          ///< contacts nearer than this are watched even at rest (m)
inline constexpr double slack = 0.0005;          ///< rows whose free gap is larger take no part (m)
inline constexpr double largestSlide = 0.005;    ///< of a tip near a surface in one step (m)
inline constexpr std::uint32_t quietSteps = 50;  ///< before an organ sleeps
inline constexpr double leastForce = 1e-6;       ///< N; below, nothing counts as touching
inline constexpr double broadCell = 0.02;        ///< m
}  // namespace stepping

/// One row of the contact problem.
struct ContactRow {
  std::size_t hand = 0;
  std::size_t organ = 0;
  ShaftContact contact;
  SolidSolver::Impulse place;     ///< where and along what the organ is pushed
  Vec3 direction = Vec3::Zero();  ///< row of T: how the tip's displacement opens the gap
  double free = 0.0;              ///< gap without forces, tip moved as far as this step lets it (m)
  double freeFull = 0.0;          ///< the same, tip at its real place
};

/// Direction from the port to a tip, unit.
Vec3 axisOf(const Vec3& port, const Vec3& tip);

struct Stepper::Workspace {
  Workspace(const Model& model_, Executor& executor_, MakeBroadPhase make) : model(model_), executor(executor_) {
    solver.resize(model.organs().size());
    skin.resize(model.organs().size());
    for (std::size_t o = 0; o < model.organs().size(); ++o) {
      broad.push_back(make != nullptr ? make() : std::make_unique<SortedGrid>(stepping::broadCell));
    }
    settings.step = model.stepSeconds();
    settings.tolerance = model.scene().solver.tolerance;
    settings.cap = model.scene().solver.iterations;
    result.organ.resize(model.organs().size());
    for (HandResult& hand : result.hand) hand.organForce.resize(model.organs().size());
    invalidate();
  }

  void invalidate() {
    bounded.assign(model.organs().size(), false);
    digest.reset();
    for (ContactSet& set : contactSet) set = {};
  }

  void readSamples(State& state, std::span<const TickSamples> samples);

  void refreshBounds(const State& state);
  void patchesNear(std::size_t organ, const Box& box, std::vector<std::uint32_t>& out);
  double gapOf(const Shaft& shaft, double reach);
  void advanceFreely(State& state, std::size_t hand);
  void detect(const State& state);
  void wakeAndMove(State& state);
  void buildProblem(const State& state);
  void solveContacts(State& state);
  void applyForces(State& state);
  void finishOrgans(State& state);
  void finishHands(State& state);
  void publish(const State& state);
  void emit(EventKind kind, std::size_t hand, std::uint16_t subject, const Vec3& position, double value);

  const Model& model;
  Executor& executor;
  SolidSolver::Settings settings;
  std::vector<SolidSolver> solver;  // per organ
  std::vector<std::unique_ptr<BroadPhase>> broad;
  std::vector<bool> bounded;            // per organ: broad phase holds bounds of the current positions
  std::vector<bool> moved;              // per organ: solved in this step
  std::vector<std::vector<Vec3>> skin;  // per organ: surface points of the current positions
  std::vector<Box> bounds;
  std::vector<BroadPhase::Pair> pairs;
  std::vector<std::uint32_t> patches;
  std::vector<ShaftContact> found;
  std::array<Vec3, handCount> remaining{};  // of the tip's way to its real place (m)
  std::array<double, handCount> share{};    // of that way which this step lets it go
  std::array<double, handCount> reach{};    // how far contacts were looked for (m)
  std::vector<ContactRow> rows;
  std::vector<SolidSolver::Impulse> impulses;
  std::vector<std::vector<Vec3>> batch;
  std::vector<std::vector<Vec3>> response;  // per row: velocity of the organ's nodes for a unit impulse
  std::vector<double> compliance, freeGap, lambda;
  std::vector<std::vector<Vec3>> correction;  // per organ
  std::array<ContactSet, handCount> contactSet;
  IncrementalDigest digest;
  StepResult result;
};

}  // namespace calot
