// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "sim/math/fields.h"

namespace calot::recorder {

namespace {

/// Makes a column of every visited value.
struct Collect {
  Layout& layout;
  Stream stream = Stream::ticks;

  template <class T>
  void operator()(const char* folder, const char* name, const char* unit, const T&) {
    add<T>(folder, name, unit, false, 1);
  }
  void operator()(const char* folder, const char* name, const char* unit, const Vec3&) {
    add<double>(folder, name, unit, true, 3);
  }
  void operator()(const char* folder, const char* name, const char* unit, const Quat&) {
    add<double>(folder, name, unit, true, 4);
  }
  template <class T>
  void outside(const char* folder, const char* name, const char* unit, const T&) {
    add<T>(folder, name, unit, false, 1);
    layout.columns.back().chained = false;
  }
  template <class T>
  void list(const char* folder, const char* name, const char* unit, const std::vector<T>&, std::size_t width) {
    add<T>(folder, name, unit, true, width);
  }
  template <class Part, class T>
  void each(const char* folder, const char* name, const char* unit, const std::vector<Part>& parts, T Part::*) {
    add<T>(folder, name, unit, true, layout.countOf(parts));
  }

 private:
  template <class T>
  void add(const char* folder, const char* name, const char* unit, bool vector, std::size_t width) {
    const std::uint64_t chunkRows = stream == Stream::ticks ? layout.ticksPerBlock : layout.stepsPerBlock;
    layout.columns.push_back({fmt::format("{}/{}", folder, name), storedAs<T>(), stream, vector, width, chunkRows,
                              layout.deflateLevel, true, unit});
  }
};

}  // namespace

std::vector<std::string> namesOfComponents(const AttemptHeader& header, std::string_view prefix) {
  std::vector<std::string> names;
  for (const std::string& component : header.layout.components) {
    if (component.starts_with(prefix)) names.push_back(component.substr(prefix.size()));
  }
  return names;
}

TickOutcome asStored(const TickOutcome& tick) {
  constexpr double perNewton = 16384.0;         // 2^14
  constexpr double perNewtonMetre = 1048576.0;  // 2^20
  const auto rounded = [](const Vec3& v, double perUnit) -> Vec3 {
    Vec3 out;
    for (int i = 0; i < 3; ++i) out[i] = std::floor(v[i] * perUnit + 0.5) / perUnit;
    return out;
  };
  TickOutcome out = tick;
  for (HandTick& hand : out.hand) {
    hand.force = rounded(hand.force, perNewton);
    hand.torque = rounded(hand.torque, perNewtonMetre);
  }
  return out;
}

void shorten(const StateDigest& digest, BriefDigest& out) {
  DigestStream stream;
  for (const std::uint64_t component : digest.component) stream.append(&component, sizeof component);
  out.state = stream.value();
  out.field.clear();
  for (const std::uint32_t field : digest.field) out.field.push_back(static_cast<std::uint16_t>(field & 0xFFFFU));
}

std::uint64_t forceDigest(std::span<const TickOutcome> ticks) {
  DigestStream stream;
  for (const TickOutcome& tick : ticks) {
    for (const HandTick& hand : tick.hand) {
      stream.append(hand.force.data(), 3 * sizeof(double));
      stream.append(hand.torque.data(), 3 * sizeof(double));
    }
  }
  return stream.value();
}

Layout::Layout(const AttemptHeader& header)
    : deviceSamples(header.deviceSamples),
      minimal(isMinimal(header)),
      brief(header.formatVersion > 1 && !minimal),
      exactForces(header.formatVersion == 1),
      codedKeyframes(header.formatVersion > 1),
      deflateLevel(header.formatVersion == 1 ? 1 : 6),
      ticksPerStep(header.ticksPerStep),
      components(header.layout.components.size()),
      fields(header.layout.fields.size()),
      resultVersion(header.stepResultVersion) {
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId id) {
    if (Kind::results.since > resultVersion) return;
    count[id] = namesOf<Kind>(header).size();
    if (Kind::hasStructures) structures += count[id];
  });
  procedure = !minimal && resultVersion == 3 && namesOfComponents(header, "procedure").size() == 1;
  stepsPerBlock = std::max<std::uint64_t>(1, 250 / ticksPerStep);
  ticksPerBlock = stepsPerBlock * ticksPerStep;

  Collect collect{*this};
  TickSamples samples;
  TickOutcome outcome;
  visitTick(samples, outcome, collect);
  tickColumns = columns.size();
  collect.stream = Stream::steps;
  RecordedStep step;
  visitStep(step.digest, step.brief, step.forces, step.lateness, step.result, step.procedure, collect);
  stepColumns = columns.size() - tickColumns;
  const auto isResult = [](const Column& c) { return c.path.starts_with("/observables"); };
  results = static_cast<std::size_t>(std::find_if(columns.begin(), columns.end(), isResult) - columns.begin());

  const auto irregular = [this](const char* path, Element element, Stream stream, std::uint64_t chunkRows,
                                unsigned deflate) {
    columns.push_back({path, element, stream, false, 1, chunkRows, deflate, true, ""});
    return columns.size() - 1;
  };
  events = irregular("/events", Element::event, Stream::events, 32, 0);
  keyframeIndex = irregular("/keyframes/index", Element::keyframe, Stream::keyframes, 16, 0);
  keyframeWords = irregular("/keyframes/bytes", Element::u8, Stream::keyframeWords, keyframeChunkWords, deflateLevel);
  if (minimal) columns[keyframeIndex].width = columns[keyframeWords].width = 0;
  for (std::size_t h = 0; h < raw.size(); ++h) {
    static constexpr std::array<const char*, handCount> path{"/device/left/samples", "/device/right/samples"};
    static constexpr std::array<Stream, handCount> stream{Stream::rawLeft, Stream::rawRight};
    raw[h] = irregular(path[h], Element::rawSample, stream[h], rawChunkRows, 0);
    columns.back().width = deviceSamples ? 1 : 0;
    columns.back().chained = false;
  }
  status = {"/status", Element::status, {}, false, 1, 1, 0, false, ""};
  rawCounts = {rawCountsPath, Element::rawCounts, {}, false, deviceSamples ? 1U : 0U, rawChunkRows, 0, false, ""};
}

}  // namespace calot::recorder
