// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/replay_player.h"

#include <fmt/format.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>

#include "analytics/checkpoints/collector.h"
#include "gui/attempt/recording_file.h"
#include "gui/moments/moments.h"
#include "gui/view/thread_rank.h"
#include "gui/words/problem_words.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_assets.h"
#include "recorder/recorded_results.h"

namespace calot::gui {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto pictureEvery = std::chrono::milliseconds(33);
constexpr double stepsShare = 0.025;   // s of re-simulation before the next picture
constexpr double longWay = 0.08;       // s of re-simulation from which a keyframe is shown on the way
constexpr double whileSeeking = 0.25;  // s between pictures on a long way
constexpr double firstGuess = 0.005;   // s a step, before any was measured

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

std::optional<std::uint64_t> keyframeAtOrBefore(const ReplayReach& reach, std::uint64_t step) {
  const auto after = std::upper_bound(reach.keyframes.begin(), reach.keyframes.end(), step);
  if (after == reach.keyframes.begin()) return std::nullopt;
  return *(after - 1);
}

/// From where the way to a step is shortest: here, a keyframe, or none for the attempt's start.
std::optional<std::uint64_t> bestStart(const ReplayReach& reach, std::uint64_t step) {
  const auto keyframe = keyframeAtOrBefore(reach, step);
  if (reach.step && *reach.step <= step && (!keyframe || *keyframe <= *reach.step)) return reach.step;
  return keyframe;
}

std::string withHand(std::string text, const Event& event) {
  if (event.hand < handCount) text += fmt::format(" ({} hand)", handNames[event.hand]);
  return text;
}

/// Largest force and the way of each hand, bin by bin.
class Tracer {
 public:
  Tracer(AttemptTrack& track, const recorder::AttemptHeader& header, std::uint64_t stepsPerBin, double stepSeconds)
      : track_(track),
        stepsPerBin_(stepsPerBin),
        stepSeconds_(stepSeconds),
        motion_{analytics::trackFor(header), analytics::trackFor(header)} {}

  void add(const recorder::RecordedStep& step) {
    for (const recorder::TickOutcome& tick : step.ticks) {
      for (std::size_t h = 0; h < handCount; ++h) force_[h] = std::max(force_[h], tick.hand[h].force.norm());
    }
    for (const TickSamples& tick : step.samples) {
      for (std::size_t h = 0; h < handCount; ++h) motion_[h].add(tick.hand[h]);
    }
    if (++steps_ == stepsPerBin_) finishBin();
  }
  void finishBin() {
    if (steps_ == 0) return;
    for (std::size_t h = 0; h < handCount; ++h) track_.hand[h].force.push_back(force_[h]);
    force_.fill(0.0);
    steps_ = 0;
  }
  /// Speeds, of the filtered motion: noise and tremor are no way. @pre every bin is finished
  void finish() {
    const double bin = static_cast<double>(stepsPerBin_) * stepSeconds_;
    for (std::size_t h = 0; h < handCount; ++h) {
      HandTrace& hand = track_.hand[h];
      hand.speed.assign(hand.force.size(), 0.0);
      if (hand.speed.empty()) return;
      for (const analytics::MotionSegment& segment : motion_[h].motion().segments) {
        for (std::size_t i = 1; i < segment.filtered.size(); ++i) {
          const double middle =
              analytics::gridTime(segment.first + static_cast<std::int64_t>(i), 1.0) - 0.5 / analytics::motionRate;
          const auto at = std::min(static_cast<std::size_t>(middle / bin), hand.speed.size() - 1);
          const double length = std::min(bin, track_.seconds - static_cast<double>(at) * bin);  // the last is shorter
          hand.speed[at] += analytics::lengthOf(segment.filtered[i] - segment.filtered[i - 1]) / length;
        }
      }
    }
  }

 private:
  AttemptTrack& track_;
  std::uint64_t stepsPerBin_, steps_ = 0;
  double stepSeconds_;
  std::array<analytics::MotionTrack, handCount> motion_;
  std::array<double, handCount> force_{};
};

}  // namespace

/// The thread's own: recording, seeker and where they stand.
class ReplayPlayer::Run {
 public:
  explicit Run(ReplayPlayer& player)
      : player_(player),
        recording_(openBeginning(player.file_, player.attempt_)),
        seeker_(recording_),
        stepSeconds_(recording_.seconds() / static_cast<double>(recording_.stepCount())) {
    position_.steps = recording_.stepCount();
    position_.seconds = recording_.seconds();
  }

  void loop() {
    goTo(0);
    if (player_.receiver_.glimpse && !wasReadThrough(player_.file_))
      player_.receiver_.glimpse(std::make_shared<const SceneView>(seeker_.view()));
    readThrough(player_.file_);
    publish(true, false);
    for (;;) {
      Asked wish;
      {
        std::unique_lock lock(player_.mutex_);
        player_.wake_.wait(lock, [&] { return player_.wish_.number != seen_ || player_.wish_.playing; });
        wish = player_.wish_;
        player_.wish_.time.reset();
        player_.wish_.steps = 0;
      }
      if (wish.stop) return;
      if (wish.number != seen_) take(wish);
      if (wish.playing) playOn();
    }
  }

 private:
  [[nodiscard]] ReplayReach reach() const {
    const double budget = std::max(1.0, stepsShare / stepCost_);
    return {done_, recording_.keyframeSteps(), static_cast<std::uint64_t>(std::min(budget, 1e6))};
  }
  [[nodiscard]] bool newerWish() const {
    const std::lock_guard lock(player_.mutex_);
    return player_.wish_.number != seen_;
  }

  void goTo(std::uint64_t step) {
    const std::uint64_t steps = stepsTo(reach(), step);
    const auto begin = Clock::now();
    seekAsRecorded(seeker_, recording_, step);
    done_ = step;
    if (steps > 0) stepCost_ += 0.2 * (secondsSince(begin) / static_cast<double>(steps) - stepCost_);
  }

  void publish(bool settled, bool hopping) {
    position_.step = *done_;
    position_.time = static_cast<double>(*done_ + 1) * stepSeconds_;
    position_.settled = settled;
    position_.hopping = hopping;
    player_.receiver_.moment(std::make_shared<const SceneView>(seeker_.view()), position_);
  }

  void take(const Asked& wish) {
    seen_ = wish.number;
    position_.playing = wish.playing;
    position_.speed = wish.speed;
    std::uint64_t target = goal_.value_or(*done_);
    if (wish.time) target = stepAt(recording_, *wish.time);
    if (wish.steps != 0) {
      const auto last = static_cast<std::int64_t>(position_.steps) - 1;
      target =
          static_cast<std::uint64_t>(std::clamp<std::int64_t>(static_cast<std::int64_t>(target) + wish.steps, 0, last));
    }
    if (wish.playing && !wish.time && target + 1 == position_.steps) target = 0;
    seek(target);
    restartClock();
  }

  /// Goes to a step, as long as nothing newer is wished for.
  void seek(std::uint64_t target) {
    goal_ = target;
    auto lastPicture = Clock::now();
    bool first = true;
    while (done_ != target) {
      if (newerWish()) return;
      const std::uint64_t next = seekTowards(reach(), target);
      const bool jumped = next != target && stepsTo(reach(), next) == 0;
      goTo(next);
      const double left = static_cast<double>(target - next) * stepCost_;
      if (next != target && ((first && jumped && left > longWay) || secondsSince(lastPicture) > whileSeeking)) {
        publish(false, false);
        lastPicture = Clock::now();
      }
      first = false;
    }
    goal_.reset();
    publish(true, false);
  }

  void restartClock() {
    clockBegin_ = Clock::now();
    clockStep_ = *done_;
  }

  void playOn() {
    const auto picture = Clock::now();
    const double passed = secondsSince(clockBegin_) * position_.speed;
    const double due = static_cast<double>(clockStep_) + passed / stepSeconds_;
    const std::uint64_t last = position_.steps - 1;
    const auto dueStep = static_cast<std::uint64_t>(std::min(due, static_cast<double>(last)));
    bool hops = false;
    const bool moves = dueStep > *done_;
    if (moves) {
      const ReplayMove move = playTowards(reach(), dueStep);
      hops = move.hops;
      goTo(move.step);
    }
    const bool ended = *done_ == last;
    if (ended) {
      const std::lock_guard lock(player_.mutex_);
      // Whoever wished for something else meanwhile is asked first.
      if (player_.wish_.number == seen_) player_.wish_.playing = position_.playing = false;
    }
    if (moves || ended) publish(true, hops);
    std::unique_lock lock(player_.mutex_);
    player_.wake_.wait_until(lock, picture + pictureEvery, [&] { return player_.wish_.number != seen_; });
  }

  ReplayPlayer& player_;
  recorder::Recording recording_;
  recorder::Seeker seeker_;
  const double stepSeconds_;
  PlayerPosition position_;
  std::optional<std::uint64_t> done_;  ///< the seeker's step
  std::optional<std::uint64_t> goal_;  ///< of a seek that something newer broke off
  double stepCost_ = firstGuess;       ///< s, of late
  std::uint64_t seen_ = 0;             ///< wishes taken
  Clock::time_point clockBegin_;
  std::uint64_t clockStep_ = 0;
};

ReplayPlayer::ReplayPlayer(std::filesystem::path file, std::string attempt, Receiver receiver)
    : file_(std::move(file)),
      attempt_(std::move(attempt)),
      receiver_(std::move(receiver)),
      thread_([this] { run(); }) {}

ReplayPlayer::~ReplayPlayer() {
  {
    const std::lock_guard lock(mutex_);
    wish_.stop = true;
    ++wish_.number;
  }
  wake_.notify_one();
  thread_.join();
}

void ReplayPlayer::ask(const ReplayWish& wish) {
  {
    const std::lock_guard lock(mutex_);
    if (wish.time) {
      wish_.time = wish.time;
      wish_.steps = 0;
    }
    wish_.steps += wish.steps;
    if (wish.steps != 0) wish_.playing = false;
    if (wish.playing) wish_.playing = *wish.playing;
    if (wish.speed) wish_.speed = std::clamp(*wish.speed, slowestReplay, fastestReplay);
    ++wish_.number;
  }
  wake_.notify_one();
}

void ReplayPlayer::run() {
  stepBack(behindInterface);
  try {
    Run(*this).loop();
  } catch (const std::exception& error) {
    receiver_.failed(problemText(error));
  }
}

std::uint64_t stepsTo(const ReplayReach& reach, std::uint64_t step) {
  const auto start = bestStart(reach, step);
  return start ? step - *start : step + 1;
}

ReplayMove playTowards(const ReplayReach& reach, std::uint64_t due) {
  if (stepsTo(reach, due) <= reach.budget) return {due, reach.step && due > *reach.step + reach.budget};
  const auto start = bestStart(reach, due);
  if (start && start != reach.step) return {*start, true};
  return {std::min(due, (start ? *start : 0) + reach.budget), false};
}

std::uint64_t seekTowards(const ReplayReach& reach, std::uint64_t target) {
  const auto start = bestStart(reach, target);
  if (start && start != reach.step) return *start;
  return std::min(target, start ? *start + reach.budget : reach.budget - 1);
}

AttemptTrack readTrack(recorder::Recording& recording,
                       const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
  AttemptTrack track;
  track.seconds = recording.seconds();
  const recorder::AttemptHeader& header = recording.header();
  track.attempt = header.attempt;
  track.parent = header.parent;
  if (!track.parent.empty())
    track.forkTime = static_cast<double>(header.forkStep + 1) * header.tickSeconds * header.ticksPerStep;
  if (header.purpose == "golden") {
    track.none =
        "A golden recording holds no results of its steps: there is no timeline. The replay shows it all the same.";
    return track;
  }
  const std::uint64_t steps = recording.stepCount();
  const double stepSeconds = header.tickSeconds * static_cast<double>(header.ticksPerStep);
  const std::uint64_t stepsPerBin = std::max<std::uint64_t>(1, (steps + maxBins - 1) / maxBins);
  track.bin = static_cast<double>(stepsPerBin) * stepSeconds;
  const SubjectNames names = analytics::subjectNames(recorder::sceneFromAssets(header.assets).description);
  recorder::RecordedJudge judge(header);
  Tracer tracer(track, header, stepsPerBin, stepSeconds);
  for (std::uint64_t n = 0; n < steps; ++n) {
    const recorder::RecordedStep& step = recording.step(n);
    const double end = static_cast<double>(n + 1) * stepSeconds;
    tracer.add(step);
    const Judgement& judgement = judge.observe(step);
    const Phase phase = judgement.phase;
    if (track.phases.empty() || track.phases.back().phase != phase)
      track.phases.push_back({phase, static_cast<double>(n) * stepSeconds, end});
    track.phases.back().end = end;
    for (const Told& told : tell(judgement, names))
      track.events.push_back({end, told.title, withHand(told.text, told.event), told.marked(), told.severity});
    if (judgement.changed) track.errors = analytics::linesOf(judgement.errorList, names, stepSeconds);
    if (progress && (n % 100 == 99 || n + 1 == steps)) progress(n + 1, steps);
  }
  tracer.finishBin();
  tracer.finish();
  if (track.phases.size() == 1 && track.phases[0].phase == Phase::none) track.phases.clear();
  return track;
}

}  // namespace calot::gui
