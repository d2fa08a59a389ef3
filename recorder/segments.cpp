// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/segments.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <memory>
#include <stdexcept>

#include "recorder/replay.h"

namespace calot::recorder {

namespace {

constexpr std::chrono::milliseconds progressInterval{50};

/// A segment before has differed: what this one gives is of no interest any more.
struct NotNeeded {};

struct Result {
  std::optional<Divergence> divergence;
  std::exception_ptr error;
  StepMisses misses;
  [[nodiscard]] bool isGood() const { return !divergence && !error; }
};

/// Keeps the forces of a session's steps. Segments have no tick in common, so several may write to one log.
class ForceLog final : public Observer {
 public:
  explicit ForceLog(std::vector<TickForces>* forces) : forces_(forces) {}
  void onStep(const StepRecord& record) override {
    if (forces_ == nullptr) return;
    for (std::size_t i = 0; i < record.ticks.size(); ++i) {
      TickForces& tick = forces_->at(static_cast<std::size_t>(record.step) * record.ticks.size() + i);
      for (std::size_t h = 0; h < handCount; ++h) {
        tick.force[h] = record.ticks[i].hand[h].force;
        tick.torque[h] = record.ticks[i].hand[h].torque;
      }
    }
  }
  void onEnd(Outcome /*outcome*/) override {}

 private:
  std::vector<TickForces>* forces_;
};

/// A thread's own reader and engine. An engine that is used again keeps what it worked out of the scene.
class Verifier {
 public:
  Verifier(const std::filesystem::path& path, const EngineChoice& choice, std::vector<TickForces>* forces)
      : recording_(path), engine_(choice.make(executor_)), forces_(forces) {}

  Result run(const Segment& segment, const std::function<void()>& stepped) {
    Result result;
    if (!segment.keyframe) engine_->start(recording_.header().seed);
    if (segment.keyframe) {
      // The recording names the contact sets of the ticks before; the segment before verifies them.
      const RecordedStep& before = recording_.step(segment.first - 1);
      const std::array named{before.ticks.back().hand[0].contactSet, before.ticks.back().hand[1].contactSet};
      if (!engine_->restore(recording_.keyframe(*segment.keyframe), named)) {
        result.divergence = Divergence{segment.first - 1, {}, "keyframe", "state", "no State of this scene's model"};
        return result;
      }
    }
    StepWatch watch;
    ForceLog log(forces_);
    const auto progress = [&](std::uint64_t /*step*/, std::uint64_t /*of*/) { stepped(); };
    result.divergence = follow(recording_, *engine_, segment.end, {&watch, &log}, progress);
    result.misses = watch.misses();
    return result;
  }

 private:
  Recording recording_;
  SerialExecutor executor_;
  std::unique_ptr<Engine> engine_;
  std::vector<TickForces>* forces_;
};

class Verification {
 public:
  Verification(const std::filesystem::path& path, const EngineChoice& choice, const std::vector<Segment>& segments,
               std::vector<TickForces>* forces)
      : path_(path),
        choice_(choice),
        segments_(segments),
        forces_(forces),
        results_(segments.size()),
        firstBad_(segments.size()) {}

  void run(unsigned threads, const std::function<void(std::uint64_t, std::uint64_t)>& progress) {
    std::vector<std::future<void>> workers;  // waited for whatever `progress` throws
    const std::size_t count = std::min<std::size_t>(threads, segments_.size());
    for (std::size_t t = 0; t < count; ++t) workers.push_back(std::async(std::launch::async, [this] { work(); }));
    std::uint64_t of = 0;
    for (const Segment& segment : segments_) of += segment.end - segment.first;
    for (const std::future<void>& worker : workers) {
      while (worker.wait_for(progressInterval) != std::future_status::ready) {
        if (progress) progress(done_, of);
      }
    }
    if (progress) progress(done_, of);
  }

  SegmentsVerdict verdict() {
    SegmentsVerdict verdict;
    const std::size_t bad = firstBad_;
    for (std::size_t i = 0; i < std::min(bad + 1, results_.size()); ++i) verdict.misses.add(results_[i].misses);
    if (bad == results_.size()) return verdict;
    if (results_[bad].error) std::rethrow_exception(results_[bad].error);
    verdict.divergence = results_[bad].divergence;
    verdict.reproducible =
        Verifier(path_, choice_, nullptr).run(segments_[bad], [] {}).divergence == verdict.divergence;
    return verdict;
  }

 private:
  void work() {
    std::unique_ptr<Verifier> verifier;
    for (std::size_t i = next_++; i < segments_.size() && i < firstBad_; i = next_++) {
      try {
        if (!verifier) verifier = std::make_unique<Verifier>(path_, choice_, forces_);
        results_[i] = verifier->run(segments_[i], [&] {
          ++done_;
          if (i > firstBad_) throw NotNeeded();
        });
      } catch (const NotNeeded&) {
        break;
      } catch (...) {
        results_[i].error = std::current_exception();
      }
      if (results_[i].isGood()) continue;
      std::size_t before = firstBad_;
      while (i < before && !firstBad_.compare_exchange_weak(before, i)) {
      }
    }
  }

  const std::filesystem::path& path_;
  const EngineChoice& choice_;
  const std::vector<Segment>& segments_;
  std::vector<TickForces>* forces_;
  std::vector<Result> results_;
  std::atomic<std::size_t> next_{0};
  std::atomic<std::size_t> firstBad_;
  std::atomic<std::uint64_t> done_{0};
};

}  // namespace

std::vector<Segment> segmentsOf(const Recording& recording) {
  std::vector<Segment> segments;
  Segment segment;
  const std::vector<std::uint64_t>& keyframes = recording.keyframeSteps();
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    segment.end = keyframes[k] + 1;
    segments.push_back(segment);
    segment = {segment.end, 0, k};
  }
  segment.end = recording.stepCount();
  if (segment.first < segment.end) segments.push_back(segment);
  return segments;
}

SegmentsVerdict verifySegments(const std::filesystem::path& recording, const EngineChoice& choice,
                               const std::vector<Segment>& segments, unsigned threads,
                               const std::function<void(std::uint64_t step, std::uint64_t of)>& progress,
                               std::vector<TickForces>* forces) {
  if (segments.empty()) throw std::invalid_argument("no segments");
  Verification verification(recording, choice, segments, forces);
  verification.run(std::max(threads, 1U), progress);
  return verification.verdict();
}

}  // namespace calot::recorder
