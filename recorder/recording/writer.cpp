// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/writer.h"

#include <fmt/format.h>
#include <time.h>
#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cmath>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "recorder/base/files.h"
#include "recorder/base/queues.h"
#include "recorder/recording/file_writer.h"
#include "recorder/recording/keyframe_code.h"
#include "recorder/recording/layout.h"

namespace calot::recorder {

namespace {

constexpr std::size_t firstBlocks = 16;  // four seconds

double threadSeconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

std::int64_t wallNow() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

struct RecordingWriter::Impl {
  Impl(std::filesystem::path to, const AttemptHeader& header)
      : target(std::move(to)), layout(header), schedule(layout, header.tickSeconds) {}

  std::filesystem::path target;
  Layout layout;
  std::optional<StationKey> key;
  std::unique_ptr<FileAppender> file;

  // The loop's side.
  std::deque<Block> pool;  // grows at its end only: blocks keep their place
  Block* filling = nullptr;
  std::uint64_t nextStep = 0;
  KeyframeSchedule schedule;
  bool ended = false, stopped = false;
  RawSampleFeed* feed = nullptr;
  std::uint64_t feedFirstTick = 0;
  std::array<std::uint64_t, handCount> dropped{};  // reported by the feed so far

  // Between the two threads.
  SpscQueue<Block*> full, empty;
  std::atomic<std::uint32_t> handedOver{0};
  std::mutex statisticsLock;
  WriterStatistics statistics;

  // The writing thread's side; read by others after join.
  KeyframeCoder coder;
  std::uint64_t keyframeWords = 0;
  std::exception_ptr error;
  std::atomic<bool> failed{false};
  std::thread thread;

  /// Stopped before its first step, which is no attempt.
  [[nodiscard]] bool unbegun() const { return stopped && nextStep == 0; }

  Block* freshBlock() {
    Block* block = nullptr;
    if (!empty.pop(block)) {
      pool.emplace_back(layout);
      block = &pool.back();
      const std::lock_guard lock(statisticsLock);
      ++statistics.blocksGrown;
    }
    return block;
  }

  void handOver(bool last) {
    filling->last = last;
    full.push(filling);
    filling = nullptr;
    handedOver.fetch_add(1, std::memory_order_release);
    handedOver.notify_one();
  }

  void write() {
    std::uint32_t seen = 0;
    for (;;) {
      Block* block = nullptr;
      while (!full.pop(block)) {
        handedOver.wait(seen, std::memory_order_acquire);
        seen = handedOver.load(std::memory_order_acquire);
      }
      const bool last = block->last;
      if (error == nullptr) flush(*block, last);
      block->clear();
      empty.push(block);
      if (last) return;
    }
  }

  void flush(Block& block, bool last) {
    const auto begin = std::chrono::steady_clock::now();
    try {
      for (const Keyframe& keyframe : block.keyframes)
        appendKeyframe(layout, keyframe, coder.code(keyframe), keyframeWords, block);
      // A block without rows is written only if it carries the outcome.
      if (block.rows[static_cast<std::size_t>(Stream::steps)] > 0 || block.completed) {
        file->append(block, wallNow());
        const std::lock_guard lock(statisticsLock);
        ++statistics.flushes;
        statistics.steps = file->last().steps;
      }
      if (last && key) file->sign(signHead(*key, file->last().chain));
      if (last) file->close();
    } catch (...) {
      error = std::current_exception();
      failed.store(true, std::memory_order_release);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const std::lock_guard lock(statisticsLock);
    statistics.maxFlushSeconds = std::max(statistics.maxFlushSeconds, seconds);
    statistics.writerSeconds = threadSeconds();
  }

  /// Moves what the device measured up to the end of the last step into the block.
  void takeRaw() {
    if (feed == nullptr) return;
    const std::uint64_t end = nextStep * layout.ticksPerStep - feedFirstTick;
    RawSample raw;
    while (feed->take(end, raw)) {
      raw.tick += feedFirstTick;
      const std::size_t column = layout.raw[static_cast<std::size_t>(raw.sample.hand)];
      appendRow(raw, filling->column[column]);
      ++filling->rows[static_cast<std::size_t>(layout.columns[column].stream)];
    }
    const std::array<std::uint64_t, handCount> now = feed->dropped();
    for (std::size_t h = 0; h < now.size(); ++h) filling->rawDropped[h] += now[h] - dropped[h];
    dropped = now;
  }

  void end(bool completed, Outcome outcome) {
    if (ended) return;
    ended = true;
    stopped = outcome == Outcome::stopped;
    filling->completed = completed;
    filling->outcome = outcome;
    handOver(true);
  }
};

RecordingWriter::RecordingWriter(const std::filesystem::path& target, const AttemptHeader& header,
                                 WriterOptions options) {
  checkHeader(header);
  assert(header.formatVersion == formatVersion);
  NewFile made(target, options.force);
  impl_ = std::make_unique<Impl>(target, header);
  Impl& impl = *impl_;
  impl.key = std::move(options.key);
  const StatusRow first =
      createRecordingFile(made.path(), header, impl.layout, impl.key ? &impl.key->publicKey : nullptr);
  impl.file = std::make_unique<FileAppender>(made.path(), impl.layout, first, true);
  made.publish();
  for (std::size_t i = 0; i < firstBlocks; ++i) {
    impl.pool.emplace_back(impl.layout);
    if (i > 0) impl.empty.push(&impl.pool.back());
  }
  impl.filling = &impl.pool.front();
  impl.thread = std::thread([&impl] { impl.write(); });
}

RecordingWriter::~RecordingWriter() {
  if (!impl_ || !impl_->thread.joinable()) return;
  impl_->end(false, Outcome::running);
  impl_->thread.join();
}

void RecordingWriter::takeRawSamples(RawSampleFeed& feed, std::uint64_t firstTick) {
  assert(impl_->layout.deviceSamples);
  impl_->feed = &feed;
  impl_->feedFirstTick = firstTick;
  impl_->dropped.fill(0);
}

void RecordingWriter::onStep(const StepRecord& record) {
  Impl& impl = *impl_;
  assert(!impl.ended && record.step == impl.nextStep);
  ++impl.nextStep;
  appendStep(impl.layout, record, *impl.filling);
  if (impl.schedule.dueAfter(record.result) && record.keyframe && !impl.layout.minimal) {
    impl.filling->keyframes.push_back(record.keyframe());
    impl.schedule.taken(impl.filling->keyframes.back().state.size());
  }
  impl.takeRaw();
  if (impl.filling->rows[static_cast<std::size_t>(Stream::steps)] == impl.layout.stepsPerBlock) {
    impl.handOver(false);
    impl.filling = impl.freshBlock();
  }
}

void RecordingWriter::onEnd(Outcome outcome) { impl_->end(outcome != Outcome::running, outcome); }

void RecordingWriter::finish() {
  Impl& impl = *impl_;
  assert(impl.ended);
  if (impl.thread.joinable()) impl.thread.join();
  impl.file.reset();
  if (impl.error != nullptr) std::rethrow_exception(impl.error);
  if (!impl.unbegun()) return;
  std::error_code ignored;
  std::filesystem::remove(linkTarget(impl.target), ignored);
}

bool RecordingWriter::failed() const { return impl_->failed.load(std::memory_order_acquire); }

bool RecordingWriter::locked() const { return impl_->file->locked(); }

WriterStatistics RecordingWriter::statistics() const {
  const std::lock_guard lock(impl_->statisticsLock);
  return impl_->statistics;
}

namespace {

/// Time of a step of the whole operation by what it reports, from a fit to all steps of one on one machine (ms).
/// Nothing but the spacing of keyframes depends on it: too large makes them closer, too small makes seeks longer.
constexpr double workOfStep = 0.2;
constexpr double workOfOrganIteration = 0.018;
constexpr double workOfFatIteration = 0.009;
constexpr double workOfContactRow = 0.017;
constexpr double workOfPass = 0.16;
constexpr double workOfCarving = 0.65;

/// State of the scene that the fit was made in, nothing carved yet.
constexpr double fittedStateBytes = 190e3;

/// Work between two keyframes (ms).
constexpr double maxWork = 125.0;

constexpr double longestSeconds = 1.0;

double workOf(const StepResult& result) {
  double work = workOfStep;
  for (const OrganResult& organ : result.organ) work += workOfOrganIteration * organ.iterations;
  for (const FatResult& fat : result.fat) {
    work += workOfFatIteration * fat.iterations;
    if (fat.carved > 0.0) work += workOfCarving;
  }
  return work + workOfContactRow * result.contact.rows + workOfPass * result.contact.passes;
}

}  // namespace

KeyframeSchedule::KeyframeSchedule(const Layout& layout, double tickSeconds) : stepsPerBlock_(layout.stepsPerBlock) {
  const double blockSeconds = static_cast<double>(layout.ticksPerBlock) * tickSeconds;
  const double blocks = std::clamp(std::floor(longestSeconds / blockSeconds + 0.5), 1.0, 1e6);
  longest_ = stepsPerBlock_ * static_cast<std::uint64_t>(blocks);
}

bool KeyframeSchedule::dueAfter(const StepResult& result) {
  ++steps_;
  ++since_;
  blockWork_ += workOf(result);
  if (steps_ % stepsPerBlock_ != 0) return false;
  work_ += blockWork_;
  // Would another block like this be too much?
  const bool much = (work_ + blockWork_) * std::max(size_, 1.0) > maxWork;
  blockWork_ = 0.0;
  return much || since_ >= longest_;
}

void KeyframeSchedule::taken(std::size_t stateBytes) {
  if (size_ <= 0.0) size_ = std::max(1e-3, static_cast<double>(stateBytes) / fittedStateBytes);
  since_ = 0;
  work_ = 0.0;
}

}  // namespace calot::recorder
