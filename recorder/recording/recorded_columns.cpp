// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/recorded_columns.h"

#include <string_view>
#include <type_traits>

#include "recorder/recording/layout.h"
#include "recorder/recording/rows.h"

namespace calot::recorder {

namespace {

static_assert(packedEventBytes == eventBytes && packedRawSampleBytes == rawSampleBytes);

/// Appends every visited value to its column, in the layout's order.
struct PackingVisitor {
  const Layout& layout;
  std::vector<RecordedColumn>& columns;
  std::size_t index = 0;

  template <class T>
  void operator()(const char*, const char*, const char*, const T& value) {
    put(value);
    ++index;
  }
  void operator()(const char*, const char*, const char*, const Vec3& v) {
    appendBytes(columns[index++].values, v.data(), 3 * sizeof(double));
  }
  void operator()(const char*, const char*, const char*, const Quat& q) {
    for (const double part : {q.w(), q.x(), q.y(), q.z()}) put(part);
    ++index;
  }
  template <class T>
  void outside(const char*, const char*, const char*, const T& value) {
    put(value);
    ++index;
  }
  template <class T>
  void list(const char*, const char*, const char*, const std::vector<T>& values, std::size_t /*width*/) {
    for (const T& value : values) put(value);
    ++index;
  }
  template <class Part, class T>
  void each(const char*, const char*, const char*, const std::vector<Part>& parts, T Part::*member) {
    for (const Part& part : parts) put(part.*member);
    ++index;
  }

 private:
  template <class T>
  void put(const T& value) {
    appendValue(columns[index].values, value);
  }
};

/// Whose value each element of a row is.
std::vector<std::string> partsOf(const Column& column, const AttemptHeader& header) {
  const std::string_view path = column.path;
  if (path == "/steps/component_digest") return header.layout.components;
  std::vector<std::string> names;
  if (path == "/steps/field_digest") {
    for (const DigestLayout::Field& field : header.layout.fields) names.push_back(field.name);
    return names;
  }
  if (path.ends_with("/organ_force")) return header.structures();
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if (path.starts_with(std::string(Kind::results.path) + "/")) names = namesOf<Kind>(header);
  });
  return names;
}

std::vector<RecordedColumn> emptyColumns(const Layout& layout, const AttemptHeader& header, std::size_t first,
                                         std::size_t count) {
  std::vector<RecordedColumn> columns;
  for (std::size_t i = first; i < first + count; ++i) {
    const Column& c = layout.columns[i];
    columns.push_back({c.path, numberType(c.element), c.unit, c.width, c.vector, partsOf(c, header), {}});
  }
  return columns;
}

}  // namespace

std::vector<std::byte> packedEvents(const std::vector<Event>& events) {
  std::vector<std::byte> bytes;
  for (const Event& event : events) appendRow(event, bytes);
  return bytes;
}

RecordedColumns recordedColumns(Recording& recording) {
  const Layout layout(recording.header());
  RecordedColumns out;
  out.ticks = emptyColumns(layout, recording.header(), 0, layout.tickColumns);
  out.steps = emptyColumns(layout, recording.header(), layout.tickColumns, layout.stepColumns);
  for (RecordedColumn& c : out.ticks)
    c.values.reserve(
        static_cast<std::size_t>(recording.tickCount() * c.width * static_cast<std::uint64_t>(c.type[1] - '0')));
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const RecordedStep& step = recording.step(n);
    for (std::size_t t = 0; t < step.samples.size(); ++t) {
      PackingVisitor visit{layout, out.ticks};
      visitTick(step.samples[t], step.ticks[t], visit);
    }
    PackingVisitor visit{layout, out.steps};
    visitStep(step.digest, step.brief, step.forces, step.lateness, step.result, step.procedure, visit);
    for (const Event& event : step.result.events) appendRow(event, out.events);
  }
  return out;
}

std::vector<std::byte> packedRawSamples(Recording& recording, Hand hand) {
  std::vector<std::byte> bytes;
  for (const RawSample& sample : recording.rawSamples(hand, 0, recording.rawSampleCount(hand)))
    appendRow(sample, bytes);
  return bytes;
}

}  // namespace calot::recorder
