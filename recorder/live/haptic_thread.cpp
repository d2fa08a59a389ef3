// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/live/haptic_thread.h"

#include <pthread.h>
#include <sched.h>
#include <sys/prctl.h>
#include <time.h>
#include <algorithm>
#include <cassert>
#include <cerrno>

#include "recorder/engine/observer.h"
#include "sim/step/hand_haptics.h"

namespace calot::recorder {

namespace {

constexpr Nanoseconds lagAllowed = std::chrono::milliseconds(100);  // maxLag

Nanoseconds read(clockid_t clock) {
  timespec t{};
  ::clock_gettime(clock, &t);
  return std::chrono::seconds(t.tv_sec) + Nanoseconds(t.tv_nsec);
}

double seconds(Nanoseconds t) { return std::chrono::duration<double>(t).count(); }
float lagSeconds(Nanoseconds t) { return static_cast<float>(seconds(t)); }

}  // namespace

Nanoseconds monotonicNow() { return read(CLOCK_MONOTONIC); }

Nanoseconds threadCpuTime() { return read(CLOCK_THREAD_CPUTIME_ID); }

void sleepUntil(Nanoseconds time) {
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(time);
  timespec t{};
  t.tv_sec = whole.count();
  t.tv_nsec = (time - whole).count();
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) == EINTR) {
  }
}

bool PacedClock::mayBegin(std::uint64_t t, Nanoseconds now, std::int64_t backlog) {
  const Nanoseconds lag = now - due(t) + std::max<std::int64_t>(backlog, 0) * tick;
  if (lag <= lagAllowed) return true;
  const Nanoseconds excess = lag - lagAllowed;
  origin_ += excess;
  stretched_ += excess;
  stretchedHere_ += excess;
  // Waiting helps only where it is the simulation that is behind.
  return backlog * tick <= lagAllowed;
}

float PacedClock::finish(std::uint64_t t, Nanoseconds ready) {
  const bool waited = stretchedHere_ > Nanoseconds(0);
  const Nanoseconds late = waited ? lagAllowed + stretchedHere_ : std::max(ready - due(t), Nanoseconds(0));
  largest_ = std::max(largest_, late);
  stretchedHere_ = Nanoseconds(0);
  // Only a tick before which the clock was stretched may say so.
  const float lateness = waited ? lagSeconds(late) : std::min(lagSeconds(late), maxLag);
  if (lateness > tickDeadline) ++missed_;
  return lateness;
}

void TickReport::take(std::uint64_t done, const PacedClock& clock) {
  ticks = done;
  missedDeadlines = clock.missed();
  maxLateness = seconds(clock.maxLateness());
  stretched = seconds(clock.stretched());
}

SourceStatus waitWhilePaused(SampleSource& source, const std::function<bool()>& stopped, PacedClock& clock,
                             SourcePauses& pauses) {
  constexpr Nanoseconds askAgain = std::chrono::milliseconds(2);
  SourceStatus status = source.status();
  if (status != SourceStatus::paused) return status;
  ++pauses.count;
  const Nanoseconds began = monotonicNow();
  while (status == SourceStatus::paused && !stopped()) {
    sleepUntil(monotonicNow() + askAgain);
    status = source.status();
  }
  const Nanoseconds length = monotonicNow() - began;
  clock.pause(length);
  pauses.seconds += seconds(length);
  return status;
}

namespace {

/// Visits the vectors among a part's fields, also of parts within it.
template <class Use>
struct Vectors {
  Use use;
  std::size_t count = 0;
  void operator()(const char* /*name*/, auto& value) { visit(value); }
  template <class T>
  void visit(std::vector<T>& values) {
    if (count++ < maxVectors) use(values);
  }
  template <class T>
  void visit(const std::vector<T>& values) {
    if (count++ < maxVectors) use(values);
  }
  template <class T>
  void visit(T& value) {
    if constexpr (requires { std::remove_const_t<T>::fields(value, *this); })
      std::remove_const_t<T>::fields(value, *this);
  }
};

template <class Part, class Use>
void forEachVector(Part& part, Use use) {
  Vectors<Use> visit{std::move(use)};
  std::remove_const_t<Part>::fields(part, visit);
}

/// Gives every vector of `to` at least the capacity of its counterpart.
void reserveLike(HapticState& to, const HapticState& like) {
  VectorSizes wanted{};
  std::size_t i = 0;
  forEachVector(like, [&](const auto& v) { wanted[i++] = v.capacity(); });
  i = 0;
  forEachVector(to, [&](auto& v) { v.reserve(wanted[i++]); });
}

}  // namespace

ContactExchange::ContactExchange(const Model& model, const HapticStates& states, const ContactSets& sets)
    : states_(states), room_(states) {
  for (std::size_t h = 0; h < handCount; ++h) model_[h] = hapticModel(model, h);
  publish(sets);
  refresh();
  grown_ = 0;
}

bool ContactExchange::outgrown(const ContactSets& sets) {
  bool grown = false;
  for (std::size_t h = 0; h < handCount; ++h) {
    std::size_t i = 0;
    forEachVector(sets[h], [&](const auto& v) {
      if (v.size() > most_[h][i]) {
        most_[h][i] = v.size();
        grown = true;
      }
      ++i;
    });
  }
  return grown;
}

void ContactExchange::makeRoom(const ContactSets& sets) {
  for (std::size_t h = 0; h < handCount; ++h) {
    HapticState tried = room_[h];
    reserveLike(tried, room_[h]);
    hapticTick(model_[h], tried, sets[h]);
    room_[h] = std::move(tried);
  }
  ++generation_;
}

void ContactExchange::publish(const ContactSets& sets) {
  Slot& slot = newest_.draft();
  slot.sets = sets;
  if (outgrown(sets)) {
    ++grown_;
    makeRoom(sets);
  }
  // Every publication carries the new capacity until the haptic thread has adopted it, since it may miss some.
  if (seen_.load(std::memory_order_acquire) < generation_ && slot.generation < generation_) {
    for (std::size_t h = 0; h < handCount; ++h) {
      slot.room[h] = room_[h];
      reserveLike(slot.room[h], room_[h]);
    }
    slot.generation = generation_;
  }
  newest_.publish();
}

void ContactExchange::refresh() {
  if (!newest_.refresh()) return;
  Slot& slot = newest_.value();
  if (slot.generation <= adopted_) return;
  for (std::size_t h = 0; h < handCount; ++h) {
    slot.room[h] = states_[h];  // it has the capacity
    std::swap(states_[h], slot.room[h]);
  }
  adopted_ = slot.generation;
  seen_.store(adopted_, std::memory_order_release);
}

namespace {

constexpr std::size_t ticksOfLag = 100;  // maxLag

/// Real-time priority if the system permits it, and precise wake-up times.
bool becomePrompt() {
  ::prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL);
  sched_param parameters{};
  parameters.sched_priority = ::sched_get_priority_min(SCHED_FIFO) + 10;
  return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters) == 0;
}

}  // namespace

HapticThread::HapticThread(const Model& model, SampleSource& source, const HapticStates& states,
                           const ContactSets& sets, Settings settings)
    : model_(model),
      source_(source),
      settings_(std::move(settings)),
      ticksPerStep_(model.scene().ticksPerStep),
      exchange_(model, states, sets),
      // A tick begins only while the next step's ticks are at most ticksOfLag old.
      ring_(ticksOfLag + 2 * static_cast<std::size_t>(ticksPerStep_) + 2),
      clock_(monotonicNow()) {
  for (std::size_t h = 0; h < handCount; ++h) hapticModel_[h] = hapticModel(model, h);
  ::sem_init(&steps_, 0, 0);
  thread_ = std::thread([this] { run(); });
}

HapticThread::~HapticThread() {
  abandoned_ = true;
  if (thread_.joinable()) thread_.join();
  ::sem_destroy(&steps_);
}

void HapticThread::run() {
  report_.realTime = becomePrompt();
  try {
    ticks();
  } catch (...) {
    fault_ = std::current_exception();
  }
  ::sem_post(&steps_);
}

void HapticThread::ticks() {
  Tick tick;
  for (std::uint64_t t = 0;; ++t) {
    if (t % ticksPerStep_ == 0) {
      if (!waitForSource()) return;
      report_.outcome = settings_.gate ? settings_.gate(t / ticksPerStep_) : Outcome::running;
      if (report_.outcome != Outcome::running) return;
    }
    if (!waitForTurn(t)) return;
    if (!source_.next(t, tick.samples)) {
      report_.outcome = source_.ending();
      return;
    }
    exchange_.refresh();
    const Nanoseconds before = threadCpuTime();
    for (std::size_t h = 0; h < handCount; ++h) {
      HapticState& state = exchange_.states()[h];
      const ContactSet& set = exchange_.sets()[h];
      takeSample(model_, h, tick.samples.hand[h], state);
      const HapticForce force = hapticTick(hapticModel_[h], state, set);
      tick.outcome.hand[h] = {force.force, force.torque, set.step};
    }
    report_.cost.add(threadCpuTime() - before);
    if (settings_.feedback) settings_.feedback(tick.outcome);
    tick.due = clock_.due(t);
    tick.outcome.lateness = clock_.finish(t, monotonicNow());
    [[maybe_unused]] const bool taken = ring_.push(tick);
    assert(taken);
    if ((t + 1) % ticksPerStep_ != 0) continue;
    report_.take(t + 1, clock_);
    ::sem_post(&steps_);
  }
}

/// Queries the source before a step. @returns false if the run ends here.
bool HapticThread::waitForSource() {
  const SourceStatus status = waitWhilePaused(
      source_, [this] { return abandoned_ || (settings_.stop != nullptr && settings_.stop->load()); }, clock_,
      report_.pauses);
  if (status == SourceStatus::failed) report_.outcome = Outcome::technicalFailure;
  return status != SourceStatus::failed && !abandoned_;
}

/// Sleeps until tick t is due and may begin. @returns false if the simulation has stopped.
bool HapticThread::waitForTurn(std::uint64_t t) {
  do {
    sleepUntil(clock_.due(t));
    if (abandoned_.load(std::memory_order_relaxed)) return false;
  } while (!clock_.mayBegin(
      t, monotonicNow(),
      static_cast<std::int64_t>(t) -
          static_cast<std::int64_t>((stepsDone_.load(std::memory_order_acquire) + 1) * ticksPerStep_)));
  return true;
}

bool HapticThread::takeStep(std::span<TickSamples> samples, std::span<TickOutcome> outcomes, Nanoseconds& due) {
  while (::sem_wait(&steps_) != 0 && errno == EINTR) {
  }
  // The end is signalled after all complete steps; ticks of an unfinished step in the ring are dropped.
  Tick tick;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!ring_.pop(tick)) return false;
    samples[i] = tick.samples;
    outcomes[i] = tick.outcome;
  }
  due = tick.due + PacedClock::tick;
  return true;
}

void HapticThread::stepDone(const ContactSets& sets) {
  exchange_.publish(sets);
  stepsDone_.fetch_add(1, std::memory_order_release);
}

const HapticReport& HapticThread::finish() {
  thread_.join();
  if (fault_) std::rethrow_exception(fault_);
  return report_;
}

}  // namespace calot::recorder
