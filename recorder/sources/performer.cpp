// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/performer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/sources/pointing.h"
#include "sim/math/elementary.h"
#include "sim/math/floating_point.h"

namespace calot::recorder {

std::unique_ptr<SampleSource> makePerformer(const PerformerProfile& profile, const SceneDescription& scene,
                                            std::uint64_t seed) {
  if (scene.connective.empty() && scene.vessels.empty() && scene.fat.empty()) {
    return std::make_unique<PerformerSource>(profile, scene, seed);
  }
  return std::make_unique<OperationSource>(profile, scene, seed);
}

namespace {

constexpr double atHome = 0.5;  // at home before the start, at rest after the end (s)

}  // namespace

OperationSource::OperationSource(const PerformerProfile& profile, const SceneDescription& scene, std::uint64_t seed)
    : profile_(profile),
      scene_(scene),
      provenance_{OperatorKind::performer, profile.name, profile.version},
      anatomy_(scene_, worker),
      hand_{PerformerHand(profile_, scene_.hands[0], 0, seed), PerformerHand(profile_, scene_.hands[1], 1, seed)},
      holding_({profile_, scene_, anatomy_, hand_}, 1 - worker, seed),
      working_({profile_, scene_, anatomy_, hand_}, worker, seed),
      judge_(scene),
      random_(seed, 23) {}

Outcome OperationSource::ending() const { return gaveUp_ ? Outcome::abandoned : Outcome::completed; }

void OperationSource::onStep(const StepRecord& record) {
  const FloatingPointScope environment;
  for (const Event& event : judge_.observe(record.result).events) {
    if (event.kind == EventKind::clipHalfOn && event.hand == worker) ++badClips_;
  }
  if (!wantsToLook_) return;
  wantsToLook_ = false;
  sight_ = anatomy_.look(record);
}

void OperationSource::decide(double time) {
  const Sight sight = std::move(*sight_);
  sight_.reset();
  for (; badClips_ > 0; --badClips_) working_.sawBadClip();
  const double freed = working_.freed(sight);
  if (hand_[1 - worker].idle(time)) holding_.decide(sight, freed, working_.divided());
  if (hand_[worker].idle(time) && holding_.ready() && !working_.done()) working_.decide(sight);
  if (working_.done() && endAt_ < 0.0) gaveUp_ = working_.failed();
  if (time > profile_.operation.patience) gaveUp_ = true;
}

/// A hand that is to go on will have nothing more to do.
bool OperationSource::idleIn(double seconds, double time) const {
  return hand_[worker].idleIn(seconds, time) || (!holding_.ready() && hand_[1 - worker].idleIn(seconds, time));
}

bool OperationSource::next(std::uint64_t tick, TickSamples& out) {
  const FloatingPointScope environment;
  const double time = static_cast<double>(tick) * tickLength;
  if (gaveUp_ && !working_.done()) return false;
  if (working_.done() && hand_[worker].idle(time)) {
    if (endAt_ < 0.0) endAt_ = time + atHome;
    if (time >= endAt_) return false;
  }
  if (sight_ && time >= decideAt_ && idleIn(0.0, time)) decide(time);
  const PerformerProfile::Perception& p = profile_.perception;
  const double ahead = working_.stirs() ? 0.0 : profile_.operation.anticipation * p.reactionTime;
  if (time >= atHome && idleIn(ahead, time) && !wantsToLook_ && !sight_ && !working_.done()) {
    wantsToLook_ = true;
    decideAt_ = time + std::clamp(p.reactionTime + p.reactionSpread * random_.normal(), 0.15, 0.6);
  }
  TickSamples samples;
  for (std::size_t h = 0; h < handCount; ++h) samples.hand[h] = hand_[h].sample(time);
  samples.camera = scene_.camera;
  out = roundedToGrid(samples);
  return true;
}

namespace {

constexpr double facing = 0.34202014332566873;  // sine of 20 degrees
constexpr double skinMargin = 0.010;            // m
constexpr double lift = 0.001;                  // lines of sight end this far off the surface (m)
constexpr double approachClearance = 0.005;     // m
constexpr double pathSpacing = 0.002;           // m
constexpr double aspect = 16.0 / 9.0;

// Inside the picture, with `tangent` that of half the vertical field of view.
bool isInPicture(const SceneDescription& scene, const Vec3& p, double tangent) {
  const Vec3 c = scene.camera.orientation.conjugate() * (p - scene.camera.position);
  return c.z() > 0.01 && std::abs(c.y()) < c.z() * tangent && std::abs(c.x()) < c.z() * tangent * aspect;
}

bool isInWorkspace(const SceneDescription& scene, const Vec3& p) {
  return (p.array() > scene.workspace[0].array() + skinMargin).all() &&
         (p.array() < scene.workspace[1].array() - skinMargin).all();
}

}  // namespace

bool isFree(const SceneSurfaces& surfaces, const Vec3& a, const Vec3& b, double clearance) {
  if (surfaces.firstHit(a, b)) return false;
  const auto pieces = static_cast<int>(std::ceil((b - a).norm() / pathSpacing)) + 1;
  for (int i = 0; i <= pieces; ++i) {
    const Vec3 p = a + (static_cast<double>(i) / pieces) * (b - a);
    if (surfaces.signedDistance(p) < clearance) return false;
  }
  return true;
}

std::vector<TouchTarget> touchTargets(const SceneDescription& scene, const SceneSurfaces& surfaces, std::size_t hand,
                                      double pullBack) {
  const double half = 0.5 * scene.verticalFieldOfView;
  const double tangent = sine(half) / cosine(half);
  const Vec3& port = scene.hands[hand].port;
  const Vec3& eye = scene.camera.position;
  std::vector<TouchTarget> targets;
  for (std::size_t o = 0; o < surfaces.organs(); ++o) {
    const TriangleMesh& mesh = surfaces.mesh(o);
    for (int t = 0; t < mesh.triangles(); ++t) {
      const Vec3 area = (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
      const double length = area.norm();
      if (!(length > 1e-12)) continue;
      TouchTarget target;
      target.organ = o;
      target.point = (mesh.corner(t, 0) + mesh.corner(t, 1) + mesh.corner(t, 2)) / 3.0;
      target.normal = area / length;
      const Vec3 toEye = eye - target.point;
      const Vec3 shaft = shaftDirection(port, target.point);
      if (target.normal.dot(toEye) < facing * toEye.norm() || target.normal.dot(shaft) > -facing) continue;
      target.approach = target.point - pullBack * shaft;
      if (!isInWorkspace(scene, target.point) || !isInWorkspace(scene, target.approach)) continue;
      if (!isInPicture(scene, target.point, tangent)) continue;
      if ((target.point - port).norm() < pullBack + skinMargin) continue;
      if (surfaces.signedDistance(target.approach) < approachClearance) continue;
      const Vec3 off = target.point + lift * target.normal;
      if (surfaces.firstHit(eye, off) || surfaces.firstHit(port, off)) continue;
      targets.push_back(target);
    }
  }
  return targets;
}

namespace {

constexpr double hover = 0.004;            // where a hand looks again before it presses: this far off the surface (m)
constexpr double travelClearance = 0.003;  // m
constexpr double openJaw = 0.5;            // rad
constexpr double settle = 0.5;             // at home before the start and after the end (s)
constexpr double bimanualLag = 0.3;        // the second hand starts this much later (s)
constexpr double tremorFadeIn = 0.5;       // unsteadiness grows from nothing: the tip starts at home (s)
constexpr double wanderFrom = 0.1;         // Hz
constexpr double wanderTo = 0.8;
constexpr int maxDraws = 400;

}  // namespace

StrokePlan::StrokePlan(const PerformerProfile& profile, const SceneDescription& scene, const SceneSurfaces& surfaces,
                       std::size_t hand, std::uint64_t seed)
    : profile_(profile),
      scene_(scene),
      surfaces_(surfaces),
      hand_(hand),
      random_(seed, 1 + hand),
      targets_(touchTargets(scene, surfaces, hand, profile.decision.pullBack)),
      time_(settle),
      tip_(scene.hands[hand].home) {}

void StrokePlan::waitUntil(double time) { time_ = std::max(time_, time); }

double StrokePlan::normal(double mean, double spread) { return mean + spread * random_.normal(); }

Vec3 StrokePlan::seenError() {
  const double across = profile_.perception.lateralError * random_.normal();
  const double down = profile_.perception.lateralError * random_.normal();
  const double along = profile_.perception.depthError * random_.normal();
  return scene_.camera.orientation * Vec3(across, down, along);
}

void StrokePlan::strokeTo(const Vec3& goal, double speed, double jaw, double roll) {
  const double length = (goal - tip_).norm();
  const double noise = profile_.motor.endpointNoise * length;
  Vec3 end;
  for (int axis = 0; axis < 3; ++axis) end[axis] = normal(goal[axis], noise);
  const double duration = std::max(length / speed, profile_.motor.minStroke);
  strokes_.push_back({time_, duration, tip_, end, jaw_, jaw, roll_, roll});
  time_ += duration;
  tip_ = end;
  jaw_ = jaw;
  roll_ = roll;
}

void StrokePlan::travelTo(const Vec3& goal, double roll) {
  const Vec3& home = scene_.hands[hand_].home;
  if (!isFree(surfaces_, tip_, goal, travelClearance)) strokeTo(home, profile_.motor.strokeSpeed, 0.0, roll);
  strokeTo(goal, profile_.motor.strokeSpeed, openJaw, roll);
}

TouchTarget StrokePlan::draw(std::size_t preferredOrgan) {
  std::vector<std::size_t> preferred, all;
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    all.push_back(i);
    if (targets_[i].organ == preferredOrgan) preferred.push_back(i);
  }
  for (const std::vector<std::size_t>* choice : {&preferred, &all}) {
    for (int n = 0; n < maxDraws && !choice->empty(); ++n) {
      const auto index = static_cast<std::size_t>(random_.uniform() * static_cast<double>(choice->size()));
      const TouchTarget& target = targets_[(*choice)[std::min(index, choice->size() - 1)]];
      if (isFree(surfaces_, scene_.hands[hand_].home, target.approach, travelClearance)) return target;
    }
  }
  throw Error(ErrorKind::invalid,
              "scene " + scene_.name + ": the " + handNames[hand_] +
                  " hand can reach no organ's surface that the camera shows; move its port or home");
}

void StrokePlan::touch(const TouchTarget& target) {
  const PerformerProfile::Motor& motor = profile_.motor;
  const PerformerProfile::Perception& perception = profile_.perception;
  const PerformerProfile::Decision& decision = profile_.decision;
  const double roll = normal(0.0, motor.rollSpread);
  wait(std::max(0.0, normal(decision.pause, decision.pauseSpread)));
  travelTo(target.approach, roll);

  // Each observation halves the perceptual error.
  Vec3 error = seenError();
  for (std::uint32_t i = 0; i <= decision.corrections; ++i) {
    wait(std::max(0.0, normal(perception.reactionTime, perception.reactionSpread)));
    strokeTo(target.point + hover * target.normal + error, motor.contactSpeed, openJaw, roll);
    error *= 0.5;
  }
  const double depth = std::max(0.0, normal(decision.pressDepth, decision.pressSpread));
  strokeTo(target.point - depth * target.normal + error, motor.contactSpeed, 0.0, roll);
  wait(decision.dwell);
  strokeTo(target.approach, motor.contactSpeed, 0.0, roll);
}

void StrokePlan::goHome() { strokeTo(scene_.hands[hand_].home, profile_.motor.strokeSpeed, 0.0, 0.0); }

PerformerSource::PerformerSource(const PerformerProfile& profile, const SceneDescription& scene, std::uint64_t seed)
    : provenance_{OperatorKind::performer, profile.name, profile.version}, hands_(scene.hands), camera_(scene.camera) {
  const FloatingPointScope environment;
  const SceneSurfaces surfaces(scene);
  std::vector<StrokePlan> plans;
  plans.reserve(handCount);
  for (std::size_t h = 0; h < handCount; ++h) plans.emplace_back(profile, scene, surfaces, h, seed);
  if (profile.decision.bimanual) plans[1].wait(bimanualLag);
  for (std::uint32_t i = 0; i < profile.decision.touches; ++i) {
    for (std::size_t h = 0; h < handCount; ++h) {
      if (!profile.decision.bimanual) plans[h].waitUntil(plans[1 - h].time());
      targets_[h].push_back(plans[h].draw((i + h) % scene.organs.size()));
      plans[h].touch(targets_[h].back());
    }
  }
  double end = 0.0;
  for (std::size_t h = 0; h < handCount; ++h) {
    plans[h].goHome();
    end = std::max(end, plans[h].time());
    strokes_[h] = plans[h].strokes();
    Random random(seed, 101 + h);
    tremor_.emplace_back(profile.motor.tremorAmplitude, profile.motor.tremorLower, profile.motor.tremorUpper, random);
    wander_.emplace_back(profile.motor.wanderAmplitude, wanderFrom, wanderTo, random);
  }
  ticks_ = static_cast<std::uint64_t>(std::ceil(std::min(end + settle, 1e6) / tickLength));
}

InstrumentSample PerformerSource::sampleOf(std::size_t hand, double time) const {
  const std::vector<Stroke>& strokes = strokes_[hand];
  // The last stroke that has begun; before the first one, its start.
  const auto after = std::upper_bound(strokes.begin(), strokes.end(), time,
                                      [](double t, const Stroke& stroke) { return t < stroke.start; });
  const Stroke& stroke = after == strokes.begin() ? strokes.front() : *(after - 1);
  const double s = minimumJerk((time - stroke.start) / stroke.duration);
  const double fade = minimumJerk(time / tremorFadeIn);

  InstrumentSample sample;
  sample.instrument = hands_[hand].instrument;
  sample.position =
      stroke.from + s * (stroke.to - stroke.from) + fade * (tremor_[hand].at(time) + wander_[hand].at(time));
  const double roll = stroke.rollFrom + s * (stroke.rollTo - stroke.rollFrom);
  sample.orientation = pointing(hands_[hand].port, sample.position, roll);
  sample.jaw = stroke.jawFrom + s * (stroke.jawTo - stroke.jawFrom);
  return sample;
}

bool PerformerSource::next(std::uint64_t tick, TickSamples& out) {
  if (tick >= ticks_) return false;
  const FloatingPointScope environment;
  const double time = static_cast<double>(tick) * tickLength;
  TickSamples samples;
  for (std::size_t h = 0; h < handCount; ++h) samples.hand[h] = sampleOf(h, time);
  samples.camera = camera_;
  out = roundedToGrid(samples);
  return true;
}

}  // namespace calot::recorder
