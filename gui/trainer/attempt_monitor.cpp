// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/attempt_monitor.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace calot::gui {
namespace {

std::size_t bedOf(const SceneDescription& scene) {
  const auto bed = std::find_if(scene.connective.begin(), scene.connective.end(),
                                [&](const auto& tissue) { return tissue.name == scene.procedure.bed; });
  return static_cast<std::size_t>(bed - scene.connective.begin());
}

constexpr int maxUnderway = 3;
constexpr std::chrono::milliseconds period(30);  // every third step: some are lost, thirty a second are to stay
/// A window that is hidden shows nothing; it is tried again so often.
constexpr std::chrono::milliseconds retryAfter(500);

std::uint64_t occasionsOf(const std::vector<AttemptError>& errors) {
  std::uint64_t sum = 0;
  for (const AttemptError& error : errors) sum += error.count;
  return sum;
}

/// The gravest of a step's errors, in words.
analytics::ErrorLine gravestOf(std::span<const JudgedError> found, const SubjectNames& names, double stepSeconds) {
  ErrorList list;
  list.add(found);
  return analytics::linesOf(list.all(), names, stepSeconds).front();
}

}  // namespace

double branchTime(double time, double stepSeconds) { return std::max(time - goBackBy, stepSeconds); }

AttemptMonitor::AttemptMonitor(const Model& model)
    : model_(model), judge_(model.scene()), names_(analytics::subjectNames(model.scene())), bed_(bedOf(model.scene())) {
  for (std::size_t h = 0; h < handCount; ++h) {
    lastPose_.hand[h].instrument = InstrumentKind::none;
    figures_.hand[h].instrument = model.scene().hands[h].instrument;
    figures_.hand[h].clips = model.scene().hands[h].clips;
  }
  for (const RetractionDescription& pull : model.scene().retraction)
    if (pull.stage > 0.0) figures_.retraction = pull.displacement.norm();
  figures_.vessel.resize(model.scene().vessels.size());
  figures_.seen = std::chrono::steady_clock::now();
}

void AttemptMonitor::onStep(const recorder::StepRecord& record) {
  for (const TickSamples& tick : record.samples) {
    for (std::size_t h = 0; h < handCount; ++h) {
      if (!tick.hand[h].valid) continue;
      const InstrumentKind had = lastPose_.hand[h].instrument;
      lastPose_.hand[h] = tick.hand[h];
      // On the way from one instrument to the next.
      if (tick.hand[h].instrument == InstrumentKind::none) lastPose_.hand[h].instrument = had;
    }
    lastPose_.camera = tick.camera;
  }
  std::uint32_t missed = 0;
  double stretched = 0.0;
  for (const recorder::TickOutcome& tick : record.ticks) {
    if (tick.lateness > recorder::tickDeadline) ++missed;
    if (tick.lateness > recorder::maxLag) stretched += static_cast<double>(tick.lateness - recorder::maxLag);
  }
  const Judgement& judgement = judge_.observe(record.result);

  const CameraSample& camera = record.samples.back().camera;
  const std::lock_guard lock(mutex_);
  figures_.time = static_cast<double>(record.step + 1) * model_.stepSeconds();
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandResult& hand = record.result.hand[h];
    figures_.hand[h] = {hand.instrument,
                        hand.jaw,
                        hand.grasping != 0,
                        hand.clips,
                        hand.cautery,
                        record.samples.back().hand[h].valid,
                        camera.orientation.conjugate() * Vec3(hand.tipSimulated - camera.position),
                        hand.orientation,
                        hand.contactForce.norm(),
                        depthOf(h, hand),
                        std::max(figures_.hand[h].greatestForce, hand.contactForce.norm())};
    figures_.touched = figures_.touched || hand.contacts() != 0 || hand.cautery == Cautery::onTissue;
  }
  for (std::size_t v = 0; v < record.result.vessel.size(); ++v)
    figures_.vessel[v] = {record.result.vessel[v].clips, record.result.vessel[v].partings};
  for (const Event& event : record.result.events)
    if (event.kind == EventKind::retractionMore || event.kind == EventKind::retractionLess)
      figures_.retraction = event.value;
  figures_.procedure = judgement;
  if (bed_ < record.result.connective.size()) figures_.attached = record.result.connective[bed_].attached;
  figures_.ticks += record.ticks.size();
  figures_.missedDeadlines += missed;
  figures_.missedLately += missed;
  figures_.missedLately -= missed_[slot_];
  missed_[slot_] = missed;
  slot_ = (slot_ + 1) % missed_.size();
  figures_.stretched += stretched;
  if (judgement.changed) noteErrors(judgement);
  figures_.seen = std::chrono::steady_clock::now();
}

void AttemptMonitor::noteErrors(const Judgement& judgement) {
  figures_.errors = std::make_shared<const std::vector<analytics::ErrorLine>>(
      analytics::linesOf(judgement.errorList, names_, model_.stepSeconds()));
  const std::uint64_t before = std::exchange(occasions_, occasionsOf(judgement.errorList));
  if (occasions_ <= before || judgement.found.empty()) return;
  ++figures_.noticed;
  figures_.latest =
      std::make_shared<const analytics::ErrorLine>(gravestOf(judgement.found, names_, model_.stepSeconds()));
}

double AttemptMonitor::depthOf(std::size_t h, const HandResult& hand) {
  const double force = hand.contactForce.norm();
  if (hand.touching == 0 || !(force > 0.0)) {
    touchedAt_[h].reset();
    return 0.0;
  }
  if (!touchedAt_[h]) touchedAt_[h] = hand.tipSimulated;
  return std::max(0.0, Vec3(*touchedAt_[h] - hand.tipSimulated).dot(hand.contactForce) / force);
}

void AttemptMonitor::beginRun() {
  const std::lock_guard lock(mutex_);
  missed_ = {};
  figures_.ticks = figures_.missedDeadlines = figures_.missedLately = 0;
  figures_.stretched = 0.0;
  figures_.seen = std::chrono::steady_clock::now();
}

void AttemptMonitor::expectSteps() {
  const std::lock_guard lock(mutex_);
  figures_.seen = std::chrono::steady_clock::now();
}

AttemptFigures AttemptMonitor::figures() const {
  const std::lock_guard lock(mutex_);
  return figures_;
}

void MotionClock::asked(std::uint64_t step, Time now) {
  Entry& entry = entries_[step % kept];
  // A concurrent reader finds no step here.
  entry.step.store(~std::uint64_t{0}, std::memory_order_seq_cst);
  entry.ticks.store(now.time_since_epoch().count(), std::memory_order_seq_cst);
  entry.step.store(step, std::memory_order_seq_cst);
}

std::optional<MotionClock::Time> MotionClock::of(std::uint64_t step) const {
  const Entry& entry = entries_[step % kept];
  if (entry.step.load(std::memory_order_seq_cst) != step) return std::nullopt;
  const Time time{Time::duration(entry.ticks.load(std::memory_order_seq_cst))};
  if (entry.step.load(std::memory_order_seq_cst) != step) return std::nullopt;
  return time;
}

bool ClockedSource::next(std::uint64_t tick, TickSamples& out) {
  if (!source_.next(tick, out)) return false;
  if ((tick + 1) % ticksPerStep_ == 0) clock_.asked(firstStep_ + tick / ticksPerStep_, MotionClock::Time::clock::now());
  return true;
}

void PictureRate::setRunning(bool running) {
  running_ = running;
  if (!running_) last_.reset();
}

void PictureRate::shown(Time now, double side, std::optional<double> delay) {
  if (!running_) return;
  if (last_) {
    const double wait = std::chrono::duration<double>(now - *last_).count();
    ++pictures_;
    sides_ += side;
    if (delay) delays_.push_back(static_cast<float>(*delay));
    seconds_ += wait;
    longest_ = std::max(longest_, wait);
  }
  last_ = now;
}

std::optional<double> PictureRate::delay(double share) const {
  if (delays_.empty()) return std::nullopt;
  std::vector<float> sorted = delays_;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(share * static_cast<double>(sorted.size()))) - 1;
  const auto at = sorted.begin() + std::clamp<std::ptrdiff_t>(rank, 0, static_cast<std::ptrdiff_t>(sorted.size()) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return *at;
}

std::string PictureRate::report(int width, int height, const std::string& drawnBy) const {
  std::string line = fmt::format("{:.1f} pictures a second of {}x{} in {:.1f} s, one stood for {:.2f} s at most",
                                 mean(), width, height, seconds_, longest_);
  if (side() < 0.995) line += fmt::format("; drawn at {:.0f} % of the width in the mean", 100.0 * side());
  if (const auto typical = delay(0.5))
    line += fmt::format("; motion to picture {:.0f} ms, 95 % within {:.0f} ms", 1e3 * *typical, 1e3 * *delay(0.95));
  return line + "; drawn by " + drawnBy;
}

void ViewTap::handOut(SceneView view) {
  fallen_->show(view);
  sink_(std::make_shared<const SceneView>(std::move(view)));
}

void ViewTap::begin(recorder::Session& session) {
  underway_ = 1;
  fallen_.emplace(session.model().scene().clip, session.model().stepSeconds());
  for (const Event& event : before_) fallen_->add(event);
  handOut(session.view());
}

void ViewTap::onStep(const recorder::StepRecord& record) {
  for (const Event& event : record.result.events) fallen_->add(event);
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  if (underway_ >= maxUnderway && now < last_ + retryAfter) return;
  // The mean is kept, not the distance.
  next_ = now - next_ > period ? now + period : next_ + period;
  last_ = now;
  ++underway_;
  ++taken_;
  handOut(record.view());
}

}  // namespace calot::gui
