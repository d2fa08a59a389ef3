// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/state.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/instruments/instrument_shape.h"
#include "sim/math/fields.h"
#include "sim/math/linear.h"
#include "sim/vessel/tube_surface.h"

namespace calot {

RetractionState retractionsAtStart(const SceneDescription& scene) {
  RetractionState state;
  for (const RetractionDescription& d : scene.retraction) {
    state.from.push_back(0.0);
    state.speed.push_back(0.0);
    state.goal.push_back(1.0);
    state.begun.push_back(d.start);
    state.takes.push_back(d.duration);
  }
  return state;
}

bool fits(const SceneDescription& scene, const RetractionState& state) {
  const std::size_t count = scene.retraction.size();
  return state.from.size() == count && state.speed.size() == count && state.goal.size() == count &&
         state.begun.size() == count && state.takes.size() == count &&
         std::all_of(state.takes.begin(), state.takes.end(), [](double takes) { return takes > 0.0; });
}

RetractionPlace retractionAt(const RetractionState& state, std::size_t which, double time) {
  const double takes = state.takes[which];
  const double s = std::min(notNegative((time - state.begun[which]) / takes), 1.0);
  const double way = state.goal[which] - state.from[which];
  const double speed = state.speed[which];
  // Hermite's cubic from (from, speed) to (goal, 0).
  return {state.from[which] + way * (s * s * (3.0 - 2.0 * s)) + speed * takes * (s * (1.0 - s) * (1.0 - s)),
          way * (6.0 * s * (1.0 - s) / takes) + speed * ((1.0 - s) * (1.0 - 3.0 * s))};
}

bool isMoving(const RetractionState& state, std::size_t which, double time) {
  return time >= state.begun[which] && time < state.begun[which] + state.takes[which];
}

void askForRetraction(const RetractionDescription& of, std::size_t which, double time, bool more,
                      RetractionState& state) {
  const double goal = std::min(notNegative(state.goal[which] + (more ? of.stage : -of.stage)), of.most);
  if (goal == state.goal[which]) return;
  const RetractionPlace now = retractionAt(state, which, time);
  state.from[which] = now.share;
  state.speed[which] = now.rate;
  state.goal[which] = goal;
  state.begun[which] = std::max(time, of.start);
  state.takes[which] = of.duration * std::max(std::abs(goal - now.share), of.stage);
}

namespace {

/// Collects the names of a part's fields.
struct NameVisitor {
  DigestLayout& layout;
  std::uint32_t component;
  template <class T>
  void operator()(const char* name, const T& /*value*/) {
    layout.fields.push_back({component, layout.components[component] + "/" + name});
  }
};

/// Serialises a part and remembers where each field ends.
struct PieceVisitor {
  ByteWriter writer;
  const std::vector<std::byte>& bytes;
  std::vector<std::size_t>& ends;
  template <class T>
  void operator()(const char* name, const T& value) {
    writer(name, value);
    ends.push_back(bytes.size());
  }
};

/// No number of a State (m, m/s, N, components of unit quaternions) comes near this one; from larger ones, which
/// damaged bytes hold, a step would overflow.
constexpr double maxNumber = 1e6;

struct FiniteVisitor {
  bool finite = true;
  template <class T>
  void operator()(const char* /*name*/, const T& value) {
    check(value);
  }
  void check(double v) { finite = finite && std::abs(v) <= maxNumber; }
  template <class T>
  requires(std::is_integral_v<T> || std::is_enum_v<T>) void check(T /*value*/) {}
  void check(const Vec3& v) {
    for (int i = 0; i < 3; ++i) check(v[i]);
  }
  void check(const Quat& q) {
    for (int i = 0; i < 4; ++i) check(q.coeffs()[i]);
  }
  template <class T, std::size_t N>
  void check(const std::array<T, N>& values) {
    for (const T& v : values) check(v);
  }
  template <class T>
  void check(const std::vector<T>& values) {
    for (const T& v : values) check(v);
  }
};

template <class Part>
void digestPart(const Part& part, std::uint64_t& component, std::uint32_t* field, std::vector<std::byte>& bytes,
                std::vector<std::size_t>& ends) {
  bytes.clear();
  ends.clear();
  PieceVisitor visitor{ByteWriter(bytes), bytes, ends};
  Part::fields(part, visitor);
  component = digest64(bytes);
  std::size_t start = 0;
  const std::span<const std::byte> all(bytes);
  for (const std::size_t end : ends) {
    *field++ = static_cast<std::uint32_t>(digest64(all.subspan(start, end - start)));
    start = end;
  }
}

template <class Part>
std::size_t fieldCount() {
  DigestLayout layout;
  layout.components.emplace_back();
  NameVisitor visitor{layout, 0};
  const Part part{};
  Part::fields(part, visitor);
  return layout.fields.size();
}

/// @pre vessels fit
std::size_t skinVertices(const Model& model, const State& state, std::size_t structure) {
  const StructureModel& s = model.structures()[structure];
  if (s.kind == tissueId<OrganTissue>) return model.organs()[s.index].skin.size();
  TubeSurface tube(model.vesselTrees()[s.index].beams, s.branch, tubeSettings);
  tube.update(state.vessel[s.index]);
  return tube.vertices();
}

}  // namespace

State initialState(const Model& model, std::uint64_t seed) {
  State state;
  const SceneDescription& scene = model.scene();
  state.clock.random = Random(seed, 1);
  state.camera.position = scene.camera.position;
  state.camera.orientation = scene.camera.orientation;
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandDescription& hand = scene.hands[h];
    HandState& s = state.hand[h];
    const Pose pose = throughPort(hand.port, hand.home, Quat::Identity(), Vec3(0.0, 0.0, -1.0));
    s.input.position = s.instrument.position = pose.position;
    s.input.orientation = s.instrument.orientation = pose.orientation;
    s.instrument.kind = hand.instrument;
    s.instrument.clips = hand.clips;
    s.touches.since.assign(model.structures().size(), 0);
  }
  state.retraction = retractionsAtStart(scene);
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) { Kind::start(model, state); });
  return state;
}

DigestLayout digestLayout(const Model& model) {
  const State state = initialState(model, 0);
  DigestLayout layout;
  const auto add = [&](std::string name, const auto& part) {
    NameVisitor visitor{layout, static_cast<std::uint32_t>(layout.components.size())};
    layout.components.push_back(std::move(name));
    std::remove_cvref_t<decltype(part)>::fields(part, visitor);
  };
  State::ownComponents(
      state, [&](const std::string& prefix, const char* name, const auto& part) { add(prefix + name, part); });
  State::tissueComponents(state, [&]<class Kind>(std::type_identity<Kind>, const char* prefix, std::size_t index,
                                                 const auto& part) { add(prefix + Kind::nameOf(model, index), part); });
  return layout;
}

StateDigest digestOf(const State& state) {
  IncrementalDigest digest;
  return digest.update(state, {});
}

const StateDigest& IncrementalDigest::update(const State& state, const std::vector<bool>& written) {
  std::vector<std::byte> bytes;
  std::vector<std::size_t> ends;
  std::size_t component = 0;
  std::size_t field = 0;
  State::components(state, [&](const auto& part) {
    using Part = std::remove_cvref_t<decltype(part)>;
    static const std::size_t count = fieldCount<Part>();
    if (digest_.component.size() <= component) digest_.component.resize(component + 1);
    if (digest_.field.size() < field + count) digest_.field.resize(field + count);
    if (!valid_ || written[component]) {
      digestPart(part, digest_.component[component], digest_.field.data() + field, bytes, ends);
    }
    ++component;
    field += count;
  });
  valid_ = true;
  return digest_;
}

std::vector<std::byte> saveState(const State& state) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  State::components(state, [&](const auto& part) { writer.write(part); });
  return bytes;
}

namespace {

/// Is the structure of a dimple's key one that has dimples?
bool isDimpleOf(const Model& model, std::uint64_t key) {
  const std::uint64_t structure = key >> 8U;
  return structure < model.structures().size() && model.structures()[structure].soft != nullptr;
}

bool fits(const Model& model, const TouchState& touches) {
  return touches.since.size() == model.structures().size() && touches.key.size() == touches.force.size() &&
         touches.dimpleKey.size() == touches.dimple.size() &&
         std::all_of(touches.dimpleKey.begin(), touches.dimpleKey.end(),
                     [&](std::uint64_t key) { return isDimpleOf(model, key); });
}

/// @pre vessels of `state` fit
bool fits(const Model& model, const State& state, const GraspState& grasp) {
  const std::size_t held = grasp.node.size();
  if (grasp.weight.size() != held || grasp.place.size() != held || grasp.force.size() != held) return false;
  if ((grasp.structure == noStructure) != (held == 0)) return false;
  if (held == 0) return true;
  if (grasp.structure >= model.structures().size()) return false;
  // The stepper discards contact points whose fat was carved away.
  if (model.structures()[grasp.structure].kind == tissueId<FatTissue>) return true;
  const std::size_t vertices = skinVertices(model, state, grasp.structure);
  return std::all_of(grasp.node.begin(), grasp.node.end(), [&](const std::array<std::uint32_t, 3>& corners) {
    return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t corner) { return corner < vertices; });
  });
}

bool fits(const Model& model, const BurnState& burn) {
  return burn.tissue == noStructure || burn.tissue < smokeOfConnective + model.connective().size();
}

}  // namespace

bool fits(const ResponseState& state) {
  const std::size_t points = std::accumulate(state.points.begin(), state.points.end(), std::size_t{0});
  return state.key.size() == points && state.force.size() == points && state.motion.size() == points;
}

bool restoreState(const Model& model, std::span<const std::byte> bytes, State& state) {
  State read = initialState(model, 0);
  ByteReader reader(bytes);
  State::components(read, [&](auto& part) { reader.read(part); });
  if (!reader.complete()) return false;
  FiniteVisitor finite;
  State::components(read, [&](const auto& part) { std::remove_cvref_t<decltype(part)>::fields(part, finite); });
  if (!finite.finite) return false;
  bool tissueFits = true;
  Tissues::forEach(
      [&]<class Kind>(std::type_identity<Kind>, TissueId) { tissueFits = tissueFits && Kind::fits(model, read); });
  if (!tissueFits) return false;
  for (const HandState& hand : read.hand) {
    if (!fits(model, hand.touches) || !fits(model, read, hand.grasp) || !fits(model, hand.burn)) return false;
  }
  if (read.tissue.key.size() != read.tissue.force.size() || !fits(read.response)) return false;
  if (!fits(model.scene(), read.retraction)) return false;
  state = std::move(read);
  return true;
}

}  // namespace calot
