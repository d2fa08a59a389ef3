// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/contact_sets.h"

#include <memory>
#include <utility>
#include <vector>

#include "sim/haptics/haptic_tick.h"
#include "sim/step/stepper.h"
#include "tests/bench/touch_motion.h"

namespace calot::bench {

namespace {

/// The first blocks of a set; what the others pushed is left out.
ContactSet firstBlocks(const ContactSet& set, std::size_t blocks) {
  ContactSet out;
  out.step = set.step;
  out.reference = set.reference;
  const std::size_t all = set.free.size();
  std::size_t rows = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    out.kind.push_back(set.kind[b]);
    out.limit.push_back(set.limit[b]);
    rows += blockRows(set.kind[b]);
  }
  for (std::size_t i = 0; i < rows; ++i) {
    out.direction.push_back(set.direction[i]);
    out.free.push_back(set.free[i]);
    out.rate.push_back(set.rate[i]);
    out.lambda.push_back(set.lambda[i]);
    for (std::size_t j = 0; j < rows; ++j) out.compliance.push_back(set.compliance[i * all + j]);
  }
  return out;
}

}  // namespace

std::optional<PublishedSet> setOfLaidShaft(std::size_t contacts) {
  const LaidShaft laid = shaftLaidAlongLiver();
  const std::unique_ptr<const Model> model = built(laid.scene);
  SerialExecutor executor;
  Stepper stepper(*model, executor);
  State state = initialState(*model, 1);
  for (const std::vector<TickSamples>& ticks : laid.motion.step) {
    stepper.step(state, ticks);
    const ContactSet& set = stepper.contactSet(laidHand);
    if (set.kind.size() < contacts) continue;
    const HandState& hand = state.hand[laidHand];
    return PublishedSet{
        hapticModel(*model, laidHand), firstBlocks(set, contacts), {hand.input.position, hand.input.orientation}};
  }
  return std::nullopt;
}

PublishedSet rowOfContacts(std::size_t contacts, bool allDeep) {
  constexpr double apart = 0.002;       // m
  constexpr double coupled = 2e-3;      // compliance of a place under itself (m/N)
  constexpr double half = 0.004;        // m
  constexpr double stiffness = 1000.0;  // of the virtual coupling (N/m)
  constexpr double length = 0.2;        // of the shaft (m)
  PublishedSet out;
  ContactSet& set = out.set;
  const Vec3 port(0.0, 0.0, -length);
  for (std::size_t i = 0; i < contacts; ++i) {
    set.kind.push_back(BlockKind::frictional);
    set.limit.push_back(0.1);
    const Vec3 place(0.0, 0.0, -apart * static_cast<double>(i % 90));
    const Vec3 normal = Vec3(0.3 * static_cast<double>(i % 3) - 0.3, 1.0, 0.0).normalized();
    for (const Vec3& way : {normal, Vec3(Vec3::UnitZ()), Vec3(normal.cross(Vec3::UnitZ()))}) {
      set.direction.push_back(toolRow(port, {}, place, way));
      const double gap = allDeep ? -5e-3 : (i % 2 == 0 ? -1e-4 : 0.0);
      set.free.push_back(way == normal ? gap : 0.0);
      set.rate.push_back(0.0);
      set.lambda.push_back(0.0);
    }
  }
  const std::size_t rows = set.free.size();
  set.compliance.assign(rows * rows, 0.0);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < rows; ++j) {
      const std::size_t place = i / 3;
      const std::size_t other = j / 3;
      const double distance = apart * (static_cast<double>(place) - static_cast<double>(other));
      double& w = set.compliance[i * rows + j];
      if (i % 3 == j % 3) w = (i % 3 == 0 ? 1.0 : 0.7) * coupled / (1.0 + distance * distance / (half * half));
      w += set.direction[i].head<3>().dot(set.direction[j].head<3>()) / stiffness;
    }
    set.compliance[i * rows + i] *= 1.0 + 1e-4;
  }
  out.real = {Vec3(0.0, -5e-4, 0.0), Quat::Identity()};
  return out;
}

}  // namespace calot::bench
