// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/compare.h"

#include <fmt/format.h>

#include <bit>

#include "recorder/state_fields.h"

namespace calot::recorder {

namespace {

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

/// Compares named numbers one after the other and remembers the first that differ.
class Comparison {
 public:
  Comparison(std::uint64_t step, std::string component) : step_(step), component_(std::move(component)) {}

  void number(const std::string& field, double recorded, double here) {
    if (first_ || same(recorded, here)) return;
    first_ = Divergence{step_, {}, component_, field, fmt::format("recorded {}, here {}", recorded, here)};
  }
  void vector(const std::string& field, const Vec3& recorded, const Vec3& here) {
    for (int i = 0; i < 3; ++i) number(fmt::format("{}[{}]", field, i), recorded[i], here[i]);
  }
  void rotation(const std::string& field, const Quat& recorded, const Quat& here) {
    number(field + "[w]", recorded.w(), here.w());
    vector(field, recorded.vec(), here.vec());
  }
  template <class T>
  void whole(const std::string& field, T recorded, T here) {
    if (first_ || recorded == here) return;
    first_ = Divergence{
        step_,
        {},
        component_,
        field,
        fmt::format("recorded {}, here {}", static_cast<std::uint64_t>(recorded), static_cast<std::uint64_t>(here))};
  }
  [[nodiscard]] const std::optional<Divergence>& first() const { return first_; }

 private:
  std::uint64_t step_;
  std::string component_;
  std::optional<Divergence> first_;
};

}  // namespace

std::optional<Divergence> compareTick(std::uint64_t step, std::uint64_t tick, const TickOutcome& recorded,
                                      const TickOutcome& here) {
  for (std::size_t h = 0; h < handCount; ++h) {
    Comparison c(step, std::string("force.") + handNames[h]);
    c.vector("force", recorded.hand[h].force, here.hand[h].force);
    c.vector("torque", recorded.hand[h].torque, here.hand[h].torque);
    if (c.first()) {
      Divergence d = *c.first();
      d.tick = tick;
      return d;
    }
  }
  return std::nullopt;
}

std::optional<Divergence> compareDigest(std::uint64_t step, const DigestLayout& layout, const StateDigest& recorded,
                                        const StateDigest& here) {
  if (recorded == here) return std::nullopt;
  for (std::size_t c = 0; c < layout.components.size(); ++c) {
    if (recorded.component[c] == here.component[c]) continue;
    Divergence d{step, {}, layout.components[c], "a field that only the long digest shows", ""};
    for (std::size_t f = 0; f < layout.fields.size(); ++f) {
      if (layout.fields[f].component != c || recorded.field[f] == here.field[f]) continue;
      d.field = layout.fields[f].name.substr(layout.components[c].size() + 1);
      break;
    }
    return d;
  }
  for (std::size_t f = 0; f < layout.fields.size(); ++f) {
    if (recorded.field[f] != here.field[f]) return Divergence{step, {}, "digest", layout.fields[f].name, ""};
  }
  return std::nullopt;
}

std::optional<Divergence> compareResult(const StepResult& recorded, const StepResult& here) {
  Comparison c(here.step, "observables");
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandResult& a = recorded.hand[h];
    const HandResult& b = here.hand[h];
    const std::string name = std::string(handNames[h]) + "/";
    c.whole(name + "instrument", a.instrument, b.instrument);
    c.vector(name + "tipReal", a.tipReal, b.tipReal);
    c.vector(name + "tipSimulated", a.tipSimulated, b.tipSimulated);
    c.rotation(name + "orientation", a.orientation, b.orientation);
    c.number(name + "jaw", a.jaw, b.jaw);
    c.number(name + "insertion", a.insertion, b.insertion);
    c.vector(name + "contactForce", a.contactForce, b.contactForce);
    c.number(name + "contactTorque", a.contactTorque, b.contactTorque);
    c.whole(name + "touching", a.touching, b.touching);
    c.whole(name + "grasping", a.grasping, b.grasping);
    c.number(name + "graspForce", a.graspForce, b.graspForce);
    c.whole(name + "organForce.size", a.organForce.size(), b.organForce.size());
    for (std::size_t o = 0; !c.first() && o < b.organForce.size(); ++o) {
      c.number(fmt::format("{}organForce[{}]", name, o), a.organForce[o], b.organForce[o]);
    }
  }
  c.whole("organ.size", recorded.organ.size(), here.organ.size());
  for (std::size_t o = 0; !c.first() && o < here.organ.size(); ++o) {
    const OrganResult& a = recorded.organ[o];
    const OrganResult& b = here.organ[o];
    const std::string name = fmt::format("organ[{}]/", o);
    c.number(name + "volume", a.volume, b.volume);
    c.number(name + "largestDisplacement", a.largestDisplacement, b.largestDisplacement);
    c.number(name + "largestSpeed", a.largestSpeed, b.largestSpeed);
    c.number(name + "residual", a.residual, b.residual);
    c.whole(name + "iterations", a.iterations, b.iterations);
    c.whole(name + "asleep", a.asleep, b.asleep);
  }
  c.whole("connective.size", recorded.connective.size(), here.connective.size());
  for (std::size_t t = 0; !c.first() && t < here.connective.size(); ++t) {
    const ConnectiveResult& a = recorded.connective[t];
    const ConnectiveResult& b = here.connective[t];
    const std::string name = fmt::format("connective[{}]/", t);
    c.number(name + "attached", a.attached, b.attached);
    c.number(name + "burned", a.burned, b.burned);
    c.number(name + "torn", a.torn, b.torn);
    c.number(name + "largestPull", a.largestPull, b.largestPull);
    c.whole(name + "hookTouches", a.hookTouches, b.hookTouches);
  }
  c.whole("contact/blocks", recorded.contact.blocks, here.contact.blocks);
  c.whole("contact/rows", recorded.contact.rows, here.contact.rows);
  c.whole("contact/iterations", recorded.contact.iterations, here.contact.iterations);
  c.whole("contact/newtonSteps", recorded.contact.newtonSteps, here.contact.newtonSteps);
  c.number("contact/residual", recorded.contact.residual, here.contact.residual);
  c.whole("contact/passes", recorded.contact.passes, here.contact.passes);
  c.number("contact/error", recorded.contact.error, here.contact.error);
  c.number("contact/violation", recorded.contact.violation, here.contact.violation);
  c.number("contact/largestDepth", recorded.contact.largestDepth, here.contact.largestDepth);
  c.number("contact/pinchedDepth", recorded.contact.pinchedDepth, here.contact.pinchedDepth);
  c.number("contact/tissueDepth", recorded.contact.tissueDepth, here.contact.tissueDepth);
  c.whole("misses", recorded.misses, here.misses);
  if (c.first()) return c.first();

  Comparison e(here.step, "events");
  e.whole("count", recorded.events.size(), here.events.size());
  for (std::size_t i = 0; !e.first() && i < here.events.size(); ++i) {
    const Event& a = recorded.events[i];
    const Event& b = here.events[i];
    const std::string name = fmt::format("[{}]/", i);
    e.whole(name + "step", a.step, b.step);
    e.whole(name + "kind", a.kind, b.kind);
    e.whole(name + "hand", a.hand, b.hand);
    e.whole(name + "subject", a.subject, b.subject);
    e.vector(name + "position", a.position, b.position);
    e.number(name + "value", a.value, b.value);
  }
  return e.first();
}

std::optional<Divergence> compareKeyframe(const Model& model, const Keyframe& recorded, const Keyframe& here) {
  if (recorded.state != here.state) {
    State a;
    State b;
    Divergence d{here.step, {}, "keyframe", "state", ""};
    if (!restoreState(model, recorded.state, a) || !restoreState(model, here.state, b)) {
      d.detail = "the recorded bytes are no State of this scene's model";
      return d;
    }
    if (const auto difference = firstDifference(stateFields(model, a), stateFields(model, b))) {
      d.field = difference->field;
      d.detail =
          fmt::format("index {}: recorded {}, here {}", difference->index, difference->first, difference->second);
    }
    return d;
  }
  if (recorded.haptics != here.haptics) return Divergence{here.step, {}, "keyframe", "haptics", ""};
  return std::nullopt;
}

}  // namespace calot::recorder
