// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "sim/math/fields.h"

namespace calot::recorder {

std::size_t elementBytes(Element element) {
  switch (element) {
    case Element::u1:
      return 1;
    case Element::u2:
      return 2;
    case Element::u4:
    case Element::f4:
      return 4;
    case Element::u8:
    case Element::i8:
    case Element::f8:
      return 8;
    case Element::event:
      return eventBytes;
    case Element::keyframe:
      return keyframeBytes;
    case Element::status:
      return statusBytes;
    case Element::rawSample:
      return rawSampleBytes;
    case Element::rawCounts:
      return rawCountsBytes;
  }
  return 0;
}

const char* numberType(Element element) {
  switch (element) {
    case Element::u1:
      return "u1";
    case Element::u2:
      return "u2";
    case Element::u4:
      return "u4";
    case Element::u8:
      return "u8";
    case Element::i8:
      return "i8";
    case Element::f4:
      return "f4";
    case Element::f8:
      return "f8";
    default:
      return "";
  }
}

namespace {

template <class T>
struct Stored;
template <>
struct Stored<bool> {
  static constexpr Element element = Element::u1;
};
template <>
struct Stored<std::uint8_t> {
  static constexpr Element element = Element::u1;
};
template <>
struct Stored<InstrumentKind> {
  static constexpr Element element = Element::u1;
};
template <>
struct Stored<Cautery> {
  static constexpr Element element = Element::u1;
};
template <>
struct Stored<Phase> {
  static constexpr Element element = Element::u1;
};
template <>
struct Stored<std::uint16_t> {
  static constexpr Element element = Element::u2;
};
template <>
struct Stored<std::uint32_t> {
  static constexpr Element element = Element::u4;
};
template <>
struct Stored<std::uint64_t> {
  static constexpr Element element = Element::u8;
};
template <>
struct Stored<std::int64_t> {
  static constexpr Element element = Element::i8;
};
template <>
struct Stored<float> {
  static constexpr Element element = Element::f4;
};
template <>
struct Stored<double> {
  static constexpr Element element = Element::f8;
};

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
    Column c;
    c.path = fmt::format("{}/{}", folder, name);
    c.element = Stored<T>::element;
    c.stream = stream;
    c.vector = vector;
    c.width = width;
    c.chunkRows = stream == Stream::ticks ? layout.ticksPerBlock : layout.stepsPerBlock;
    c.deflate = layout.deflateLevel;
    c.unit = std::string(unit);
    layout.columns.push_back(std::move(c));
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
  StateDigest digest;
  BriefDigest shortDigest;
  std::uint64_t forces = 0;
  float lateness = 0.0F;
  StepResult result;
  RecordedProcedure recorded;
  visitStep(digest, shortDigest, forces, lateness, result, recorded, collect);
  stepColumns = columns.size() - tickColumns;

  const auto irregular = [this](const char* path, Element element, Stream stream, std::uint64_t chunkRows,
                                unsigned deflate) {
    Column c;
    c.path = std::string(path);
    c.element = element;
    c.stream = stream;
    c.chunkRows = chunkRows;
    c.deflate = deflate;
    columns.push_back(std::move(c));
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
}

}  // namespace calot::recorder
