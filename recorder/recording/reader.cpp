// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "recorder/recording/block.h"
#include "recorder/recording/file_reader.h"

namespace calot::recorder {

struct Recording::Impl {
  std::filesystem::path path;
  std::uint64_t fileBytes = 0;
  hdf5::Id file;
  AttemptHeader header;
  std::unique_ptr<Layout> layout;
  std::unique_ptr<ColumnReader> columns;
  std::optional<RecordedSignature> signature;
  std::vector<StatusRow> status;
  std::unique_ptr<KeyframeReader> keyframes;

  std::unique_ptr<Block> block;
  std::size_t blockRow = 0;                ///< row of /status whose block is held; 0: none
  std::vector<std::vector<Event>> events;  ///< of each step of the block
  RecordedStep current;

  Impl(const std::filesystem::path& from, Access access) : path(from) {
    const hdf5::Session session;
    file = openForReading(path, access);
    fileBytes = sizeOfFile(path);
    header = readHeader(path, file, fileBytes);
    layout = std::make_unique<Layout>(header);
    columns = std::make_unique<ColumnReader>(path, file, *layout, fileBytes);
    for (std::uint64_t row = 0; row < columns->statusRows(); ++row) {
      status.push_back(columns->readStatus(row));
      const StatusRow before = row > 0 ? status[status.size() - 2] : StatusRow{};
      if (row > 0) columns->checkFollows(before, status.back(), row);
      columns->readRawCounts(before, row, status.back());
    }
    signature = readSignature(path, file);
    keyframes = std::make_unique<KeyframeReader>(path, *layout, *columns, status.back());
    block = std::make_unique<Block>(*layout);
  }

  ~Impl() {
    const hdf5::Session session;
    columns.reset();
    file.reset();
  }

  void load(std::size_t row) {
    blockRow = 0;
    const StatusRow& before = status[row - 1];
    columns->readBlock(before, status[row], false, *block);
    columns->readRaw(before, status[row], *block);
    events.assign(static_cast<std::size_t>(status[row].steps - before.steps), {});
    for (const Event& e : parseEvents(block->column[layout->events], before, status[row]))
      events[static_cast<std::size_t>(e.step - before.steps)].push_back(e);
    blockRow = row;
  }

  /// The events between two rows of /status.
  std::vector<Event> parseEvents(std::span<const std::byte> packed, const StatusRow& before,
                                 const StatusRow& after) const {
    std::vector<Event> all(static_cast<std::size_t>(after.events - before.events));
    for (std::size_t i = 0; i < all.size(); ++i) {
      Event& e = all[i];
      static_cast<void>(parseRow(packed.subspan(i * eventBytes), e));
      const auto refuse = [&](const char* why) {
        throw hdf5::damaged(path, "/events", fmt::format("row {} {}", before.events + i, why));
      };
      if (e.step < before.steps || e.step >= after.steps) refuse("belongs to a step outside its flush");
      if (i > 0 && e.step < all[i - 1].step) refuse("belongs to an earlier step than the row before it");
      if (e.hand >= handCount && e.hand != 255) refuse("belongs to no hand");
    }
    return all;
  }

  /// Only results of a runaway step may hold numbers that are not finite.
  void refuseUnfinite(const StepResult& result) const {
    if ((result.misses & miss::runaway) != 0) return;
    for (const Event& event : result.events) {
      if (!event.position.allFinite() || !std::isfinite(event.value))
        throw hdf5::damaged(path, "/events", fmt::format("one of step {} is not finite", event.step));
    }
  }
};

Recording::Recording(const std::filesystem::path& path, Access access) : impl_(std::make_unique<Impl>(path, access)) {}
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;

const std::filesystem::path& Recording::path() const { return impl_->path; }
const AttemptHeader& Recording::header() const { return impl_->header; }
const std::vector<StatusRow>& Recording::status() const { return impl_->status; }
bool Recording::complete() const { return impl_->status.back().completed; }
Outcome Recording::outcome() const { return impl_->status.back().outcome; }
std::uint64_t Recording::stepCount() const { return impl_->status.back().steps; }
std::uint64_t Recording::tickCount() const { return impl_->status.back().ticks; }
std::uint64_t Recording::eventCount() const { return impl_->status.back().events; }
double Recording::seconds() const { return static_cast<double>(tickCount()) * impl_->header.tickSeconds; }
const std::vector<std::uint64_t>& Recording::keyframeSteps() const { return impl_->keyframes->steps(); }

const RecordedStep& Recording::step(std::uint64_t n) {
  Impl& impl = *impl_;
  assert(n < stepCount());
  const auto after = std::upper_bound(impl.status.begin(), impl.status.end(), n,
                                      [](std::uint64_t step, const StatusRow& row) { return step < row.steps; });
  const auto row = static_cast<std::size_t>(after - impl.status.begin());
  if (row != impl.blockRow) {
    const hdf5::Session session;
    impl.load(row);
  }
  const std::uint64_t first = impl.status[row - 1].steps;
  impl.current.step = n;
  const std::string fault = extractStep(*impl.layout, *impl.block, n - first, impl.current);
  if (!fault.empty()) throw Error(ErrorKind::damaged, Where{impl.path.string()}, fault);
  impl.current.result.events = impl.events[static_cast<std::size_t>(n - first)];
  impl.refuseUnfinite(impl.current.result);
  return impl.current;
}

std::vector<Event> Recording::events() const {
  if (impl_->layout->minimal) return {};
  std::vector<std::byte> bytes;
  {
    const hdf5::Session session;
    impl_->columns->readRows(impl_->layout->events, 0, eventCount(), bytes);
  }
  return impl_->parseEvents(bytes, {}, impl_->status.back());
}

const Layout& Recording::layout() const { return *impl_->layout; }
const std::vector<std::byte>& Recording::flushRows(std::size_t column) const { return impl_->block->column[column]; }

std::optional<std::size_t> Recording::keyframeAtOrBefore(std::uint64_t step) const {
  const std::vector<std::uint64_t>& steps = keyframeSteps();
  const auto after = std::upper_bound(steps.begin(), steps.end(), step);
  if (after == steps.begin()) return std::nullopt;
  return static_cast<std::size_t>(after - steps.begin()) - 1;
}

Keyframe Recording::keyframe(std::size_t index) { return impl_->keyframes->read(index); }

std::uint64_t Recording::rawSampleCount(Hand hand) const {
  return impl_->status.back().rawSamples[static_cast<std::size_t>(hand)];
}

std::uint64_t Recording::rawSamplesDropped(Hand hand) const {
  return impl_->status.back().rawDropped[static_cast<std::size_t>(hand)];
}

std::vector<RawSample> Recording::rawSamples(Hand hand, std::uint64_t first, std::uint64_t count) {
  const Impl& impl = *impl_;
  assert(first + count <= rawSampleCount(hand));
  const std::size_t column = impl.layout->raw[static_cast<std::size_t>(hand)];
  std::vector<std::byte> bytes;
  {
    const hdf5::Session session;
    impl.columns->readRows(column, first, count, bytes);
  }
  std::vector<RawSample> out(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].sample.hand = hand;
    const std::string fault = parseRow(std::span(bytes).subspan(i * rawSampleBytes), out[i]);
    if (!fault.empty())
      throw hdf5::damaged(impl.path, impl.layout->columns[column].path, fmt::format("row {} {}", first + i, fault));
  }
  return out;
}

const std::optional<RecordedSignature>& Recording::signature() const { return impl_->signature; }

ChainVerdict Recording::verifyChain() {
  Impl& impl = *impl_;
  if (chainStart(impl.header) != impl.status.front().chain) return {ChainFault::start};
  Block block(*impl.layout);
  for (std::size_t row = 1; row < impl.status.size(); ++row) {
    const StatusRow& before = impl.status[row - 1];
    const StatusRow& after = impl.status[row];
    {
      const hdf5::Session session;
      impl.columns->readBlock(before, after, true, block);
    }
    if (chainNext(*impl.layout, before, block, after) != after.chain) {
      return {ChainFault::flush, row, before.steps, after.steps,
              static_cast<double>(before.ticks) * impl.header.tickSeconds};
    }
  }
  if (impl.signature && impl.signature->value && !impl.signature->fits(impl.status.back().chain)) {
    const std::size_t last = impl.status.size() - 1;
    return {ChainFault::signature, last, last > 0 ? impl.status[last - 1].steps : 0, impl.status[last].steps};
  }
  return {};
}

}  // namespace calot::recorder
