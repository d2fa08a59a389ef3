// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/verification.h"

#include <fmt/format.h>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

#include "recorder/recording/block.h"
#include "recorder/recording/layout.h"
#include "recorder/replay.h"

namespace calot::recorder {

namespace {

/// Numbers with their names, as texts that read back to the same bits.
struct SpelledNumbers {
  std::vector<std::pair<std::string, std::string>> numbers;

  template <class T>
  void operator()(const char* name, const T& value) {
    if constexpr (std::is_same_v<T, Vec3>) {
      for (int i = 0; i < 3; ++i) numbers.emplace_back(fmt::format("{}[{}]", name, i), fmt::format("{}", value[i]));
    } else if constexpr (std::is_same_v<T, double>) {
      numbers.emplace_back(name, fmt::format("{}", value));
    } else {
      numbers.emplace_back(name, fmt::format("{}", static_cast<std::uint64_t>(value)));
    }
  }
  void operator()(const char* /*folder*/, const char* name, const char* /*unit*/, const auto& value) {
    (*this)(name, value);
  }
};

template <class T>
Divergence differs(std::uint64_t step, std::string component, std::string field, const T& recorded, const T& here) {
  return {step, {}, std::move(component), std::move(field), fmt::format("recorded {}, here {}", recorded, here)};
}

/// The first number in which two things differ. @param list(thing, visit) visits their numbers @pre they differ
template <class Thing, class List>
Divergence difference(std::uint64_t step, std::string component, const std::string& prefix, const Thing& recorded,
                      const Thing& here, const List& list) {
  SpelledNumbers a, b;
  list(recorded, a);
  list(here, b);
  const auto differing = std::mismatch(a.numbers.begin(), a.numbers.end(), b.numbers.begin());
  // NaNs may differ in bits that no text shows.
  const auto at = differing.first == a.numbers.end() ? 0 : differing.first - a.numbers.begin();
  const auto& [name, value] = a.numbers[static_cast<std::size_t>(at)];
  return differs(step, std::move(component), prefix + name, value, b.numbers[static_cast<std::size_t>(at)].second);
}

/// The first difference of a re-simulated tick's forces, bit for bit.
std::optional<Divergence> compareTick(std::uint64_t step, std::uint64_t tick, const TickOutcome& recorded,
                                      const TickOutcome& here) {
  for (std::size_t h = 0; h < handCount; ++h) {
    if (sameForces(recorded.hand[h], here.hand[h])) continue;
    const auto list = [](const HandTick& hand, SpelledNumbers& visit) {
      visit("force", hand.force);
      visit("torque", hand.torque);
    };
    Divergence d = difference(step, std::string("force.") + handNames[h], "", recorded.hand[h], here.hand[h], list);
    d.tick = tick;
    return d;
  }
  return std::nullopt;
}

/// The first differing component of the State digests and its first differing field.
std::optional<Divergence> compareDigest(std::uint64_t step, const DigestLayout& layout, const StateDigest& recorded,
                                        const StateDigest& here) {
  const bool withFields = !recorded.field.empty();  // golden recordings have none
  if (recorded.component == here.component && (!withFields || recorded.field == here.field)) return std::nullopt;
  for (std::size_t c = 0; c < layout.components.size(); ++c) {
    if (recorded.component[c] == here.component[c]) continue;
    Divergence d{step, {}, layout.components[c], "", ""};
    d.field = withFields ? "a field that only the long digest shows" : "a field (`calot state` and `calot diff` tell)";
    for (std::size_t f = 0; withFields && f < layout.fields.size(); ++f) {
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

std::optional<Divergence> compareDigest(std::uint64_t step, const DigestLayout& layout, const BriefDigest& recorded,
                                        const BriefDigest& here) {
  if (recorded == here) return std::nullopt;
  for (std::size_t f = 0; f < layout.fields.size(); ++f) {
    if (recorded.field[f] == here.field[f]) continue;
    const std::string& component = layout.components[layout.fields[f].component];
    // The digest of all is the one that counts: where it agrees, the field's own was changed.
    if (recorded.state == here.state) return Divergence{step, {}, "digest", layout.fields[f].name, ""};
    return Divergence{step, {}, component, layout.fields[f].name.substr(component.size() + 1), ""};
  }
  return Divergence{step, {}, "state", "a field that only the long digest shows", ""};
}

}  // namespace

std::optional<Divergence> compareProcedure(std::uint64_t step, const RecordedProcedure& recorded,
                                           const RecordedProcedure& here) {
  if (recorded == here) return std::nullopt;
  const auto list = [](const RecordedProcedure& p, SpelledNumbers& visit) { visitProcedure(p, visit); };
  return difference(step, "observables", "procedure/", recorded, here, list);
}

ResultComparison::ResultComparison(const AttemptHeader& header)
    : layout_(header), recorded_(layout_.columns.size()), here_(recorded_) {}

void ResultComparison::keep(const StepResult& result, Rows& rows) const {
  for (std::vector<std::byte>& row : rows) row.clear();
  AppendVisitor visit{layout_, rows, layout_.results};
  visitResult(result, visit);
  for (const Event& event : result.events) appendRow(event, rows[layout_.events]);
}

std::optional<Divergence> ResultComparison::operator()(const StepResult& recorded, const StepResult& here) {
  keep(recorded, recorded_);
  keep(here, here_);
  const auto firstDifference = [&](std::size_t column) {
    const auto differing = std::mismatch(recorded_[column].begin(), recorded_[column].end(), here_[column].begin());
    const std::size_t bytes = elementBytes(layout_.columns[column].element);
    return static_cast<std::size_t>(differing.first - recorded_[column].begin()) / bytes;
  };
  for (std::size_t c = layout_.results; c < layout_.events; ++c) {
    if (recorded_[c] == here_[c]) continue;
    const Column& column = layout_.columns[c];
    const std::size_t bytes = elementBytes(column.element);
    const std::string field = column.path.substr(std::string_view("/observables/").size());
    if (recorded_[c].size() != here_[c].size())
      return differs(here.step, "observables", field + ".size", recorded_[c].size() / bytes, here_[c].size() / bytes);
    const std::size_t index = firstDifference(c);
    const auto valueOf = [&](const std::vector<std::byte>& row) {
      std::string text;
      withNumber(column.element, row.data() + index * bytes, [&](auto number) { text = fmt::format("{}", number); });
      return text;
    };
    return differs(here.step, "observables", column.vector ? fmt::format("{}[{}]", field, index) : field,
                   valueOf(recorded_[c]), valueOf(here_[c]));
  }
  if (recorded.events.size() != here.events.size())
    return differs(here.step, "events", "count", recorded.events.size(), here.events.size());
  if (recorded_[layout_.events] == here_[layout_.events]) return std::nullopt;
  const std::size_t i = firstDifference(layout_.events);
  const auto list = [](const Event& event, SpelledNumbers& visit) { Event::fields(event, visit); };
  return difference(here.step, "events", fmt::format("[{}]/", i), recorded.events[i], here.events[i], list);
}

StepComparison::StepComparison(Recording& recording, Engine& engine)
    : recording_(recording),
      engine_(engine),
      compareResult_(recording.header()),
      minimal_(isMinimal(recording.header())),
      exactForces_(recording.header().formatVersion == 1) {}

void StepComparison::compare(const EngineStep& step) {
  if (first_) {
    if (!resolved_) resolveAtKeyframe(step);
    return;
  }
  const RecordedStep& recorded = recording_.step(step.step);
  for (std::size_t i = 0; !minimal_ && i < step.ticks.size() && !first_; ++i) {
    first_ = compareTick(step.step, step.step * step.ticks.size() + i, recorded.ticks[i],
                         exactForces_ ? step.ticks[i] : asStored(step.ticks[i]));
  }
  if (!first_ && (minimal_ || !exactForces_) && forceDigest(step.ticks) != recorded.forces)
    first_ = Divergence{step.step, {}, "force", "digest of the step's forces", ""};
  if (!first_) first_ = compareDigests(recorded, step);
  if (!first_) first_ = compareResult_(recorded.result, step.result);
  if (!first_ && !minimal_ && step.procedure != nullptr)
    first_ = compareProcedure(step.step, recorded.procedure, *step.procedure);
  if (first_) {
    resolved_ = minimal_ || !first_->detail.empty();
    if (!resolved_) resolveAtKeyframe(step);
    return;
  }
  if (const auto index = keyframeAt(step.step)) {
    first_ = compareKeyframe(*index);
    resolved_ = true;
  }
}

std::optional<Divergence> StepComparison::compareDigests(const RecordedStep& recorded, const EngineStep& step) {
  const DigestLayout& layout = recording_.header().layout;
  if (minimal_ || exactForces_) return compareDigest(step.step, layout, recorded.digest, step.digest);
  shorten(step.digest, brief_);
  return compareDigest(step.step, layout, recorded.brief, brief_);
}

std::optional<Divergence> StepComparison::compareKeyframe(std::size_t index) {
  const Keyframe recorded = recording_.keyframe(index);
  const Keyframe here = engine_.keyframe();
  if (recorded.state == here.state && recorded.haptics == here.haptics) return std::nullopt;
  const auto difference = engine_.explain(recorded).value_or(KeyframeDifference{"bytes", ""});
  return Divergence{here.step, {}, "keyframe", difference.field, difference.detail};
}

void StepComparison::fail(Divergence divergence) {
  if (!first_) first_ = std::move(divergence);
  resolved_ = true;
}

std::optional<std::size_t> StepComparison::keyframeAt(std::uint64_t step) {
  const auto index = recording_.keyframeAtOrBefore(step);
  return index && recording_.keyframeSteps()[*index] == step ? index : std::nullopt;
}

/// Digests say which field differs, not where: the next keyframe holds the values.
void StepComparison::resolveAtKeyframe(const EngineStep& step) {
  const auto index = keyframeAt(step.step);
  if (!index) return;
  resolved_ = true;
  if (const auto d = compareKeyframe(*index)) {
    first_->detail = step.step == first_->step
                         ? fmt::format("{} {}", d->field, d->detail)
                         : fmt::format("at the next keyframe, step {}: {} {}", step.step, d->field, d->detail);
  }
}

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

  void run(unsigned threads, const StepProgress& progress) {
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
                               const std::vector<Segment>& segments, unsigned threads, const StepProgress& progress,
                               std::vector<TickForces>* forces) {
  if (segments.empty()) throw std::invalid_argument("no segments");
  Verification verification(recording, choice, segments, forces);
  verification.run(std::max(threads, 1U), progress);
  return verification.verdict();
}

}  // namespace calot::recorder
