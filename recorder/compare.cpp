// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/compare.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <string_view>
#include <type_traits>

#include "recorder/recording/layout.h"

namespace calot::recorder {

namespace {

bool same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same(const Vec3& a, const Vec3& b) { return same(a[0], b[0]) && same(a[1], b[1]) && same(a[2], b[2]); }

/// Compares named numbers one after the other and remembers the first that differ.
class Comparison {
 public:
  Comparison(std::uint64_t step, std::string component) : step_(step), component_(std::move(component)) {}

  void number(const std::string& field, double recorded, double here) {
    if (first_ || same(recorded, here)) return;
    first_ = Divergence{step_, {}, component_, field, fmt::format("recorded {}, here {}", recorded, here)};
  }
  void vector(const std::string& field, const Vec3& recorded, const Vec3& here) {
    for (int i = 0; i < 3; ++i) number(fmt::format("{}[{}]", field, i), recorded[i], here[i]);
  }
  [[nodiscard]] const std::optional<Divergence>& first() const { return first_; }

 private:
  std::uint64_t step_;
  std::string component_;
  std::optional<Divergence> first_;
};

}  // namespace

std::optional<Divergence> compareTick(std::uint64_t step, std::uint64_t tick, const TickOutcome& recorded,
                                      const TickOutcome& here) {
  for (std::size_t h = 0; h < handCount; ++h) {
    if (same(recorded.hand[h].force, here.hand[h].force) && same(recorded.hand[h].torque, here.hand[h].torque))
      continue;
    Comparison c(step, std::string("force.") + handNames[h]);
    c.vector("force", recorded.hand[h].force, here.hand[h].force);
    c.vector("torque", recorded.hand[h].torque, here.hand[h].torque);
    Divergence d = *c.first();
    d.tick = tick;
    return d;
  }
  return std::nullopt;
}

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

std::optional<Divergence> compareProcedure(std::uint64_t step, const RecordedProcedure& recorded,
                                           const RecordedProcedure& here) {
  if (recorded == here) return std::nullopt;
  Comparison c(step, "observables");
  const auto number = [&](const char* field, auto a, auto b) {
    c.number(std::string("procedure/") + field, static_cast<double>(a), static_cast<double>(b));
  };
  number("phase", recorded.phase, here.phase);
  number("triangle_cleared", recorded.triangleCleared, here.triangleCleared);
  number("lower_third_freed", recorded.lowerThirdFreed, here.lowerThirdFreed);
  number("two_structures", recorded.twoStructures, here.twoStructures);
  number("critical_view_frozen", recorded.criticalViewFrozen, here.criticalViewFrozen);
  number("lower_third_attached", recorded.lowerThirdAttached, here.lowerThirdAttached);
  number("errors", recorded.errors, here.errors);
  number("critical_errors", recorded.criticalErrors, here.criticalErrors);
  return c.first();
}

namespace {

/// Instead of a place in a row:
constexpr std::ptrdiff_t noIndex = -1;
constexpr std::ptrdiff_t ofSize = -2;  ///< the number is how many there are

/// Hands every number of a result or of an event to a sink, in the order of the recording's columns; of a list also how
/// long it is, so that what differs in shape differs in a number. A sink is called with (folder, name, index, number).
template <class Sink>
struct Numbers {
  const Layout& layout;
  Sink& sink;

  template <class T>
  void operator()(const char* folder, const char* name, const char*, const T& value) {
    number(folder, name, noIndex, value);
  }
  void operator()(const char* folder, const char* name, const char*, const Vec3& v) {
    for (int i = 0; i < 3; ++i) number(folder, name, i, v[i]);
  }
  void operator()(const char* folder, const char* name, const char*, const Quat& q) {
    std::ptrdiff_t i = 0;
    for (const double v : {q.w(), q.x(), q.y(), q.z()}) number(folder, name, i++, v);
  }
  template <class T>
  void list(const char* folder, const char* name, const char*, const std::vector<T>& values, std::size_t width) {
    // An earlier version of StepResult holds fewer structures: the first ones.
    const std::size_t count = std::min(values.size(), width);
    number(folder, name, ofSize, count);
    for (std::size_t i = 0; i < count; ++i) number(folder, name, static_cast<std::ptrdiff_t>(i), values[i]);
  }
  template <class Part, class T>
  void each(const char* folder, const char* name, const char*, const std::vector<Part>& parts, T Part::*member) {
    number(folder, name, ofSize, parts.size());
    for (std::size_t i = 0; i < parts.size(); ++i)
      number(folder, name, static_cast<std::ptrdiff_t>(i), parts[i].*member);
  }
  /// Fields of an event.
  template <class T>
  void operator()(const char* name, const T& value) {
    (*this)("", name, "", value);
  }

 private:
  template <class T>
  void number(const char* folder, const char* name, std::ptrdiff_t index, T value) {
    if constexpr (std::is_floating_point_v<T>) {
      sink(folder, name, index, static_cast<double>(value));
    } else {
      sink(folder, name, index, static_cast<std::uint64_t>(value));
    }
  }
};

/// Keeps the bits alone: -0 and 0 differ, a NaN is itself.
struct KeepBits {
  std::vector<std::uint64_t>& bits;
  void operator()(const char*, const char*, std::ptrdiff_t, double value) {
    bits.push_back(std::bit_cast<std::uint64_t>(value));
  }
  void operator()(const char*, const char*, std::ptrdiff_t, std::uint64_t value) { bits.push_back(value); }
};

/// Says what the number at one place is.
struct Describe {
  std::size_t place = 0;
  std::string name, value;
  template <class T>
  void operator()(const char* folder, const char* column, std::ptrdiff_t index, T number) {
    if (place-- != 0) return;
    constexpr std::string_view root = "/observables";
    std::string_view group = folder;
    if (group.starts_with(root)) group.remove_prefix(root.size());
    if (group.starts_with('/')) group.remove_prefix(1);
    name = fmt::format("{}{}{}", group, group.empty() ? "" : "/", column);
    if (index >= 0) name += fmt::format("[{}]", index);
    if (index == ofSize) name += ".size";
    value = fmt::format("{}", number);
  }
};

template <class Sink>
void visitNumbers(const Layout& layout, const StepResult& result, Sink& sink) {
  Numbers<Sink> numbers{layout, sink};
  visitResult(result, numbers);
}

template <class Sink>
void visitNumbers(const Layout& layout, const Event& event, Sink& sink) {
  Numbers<Sink> numbers{layout, sink};
  Event::fields(event, numbers);
}

}  // namespace

struct ResultComparison::Buffers {
  Layout layout;
  std::vector<std::uint64_t> recorded, here;

  template <class What>
  std::optional<Divergence> compare(std::uint64_t step, const char* component, const What& a, const What& b) {
    recorded.clear();
    here.clear();
    KeepBits keepRecorded{recorded};
    KeepBits keepHere{here};
    visitNumbers(layout, a, keepRecorded);
    visitNumbers(layout, b, keepHere);
    if (recorded == here) return std::nullopt;
    // Where the lists are of different length, a size before it differs: the place is in both.
    const auto differing = std::mismatch(recorded.begin(), recorded.end(), here.begin(), here.end());
    const auto place = static_cast<std::size_t>(differing.first - recorded.begin());
    Describe first{place, {}, {}};
    Describe second{place, {}, {}};
    visitNumbers(layout, a, first);
    visitNumbers(layout, b, second);
    return Divergence{step, {}, component, first.name, fmt::format("recorded {}, here {}", first.value, second.value)};
  }
};

ResultComparison::ResultComparison(const AttemptHeader& header)
    : buffers_(std::make_unique<Buffers>(Buffers{Layout(header), {}, {}})) {}
ResultComparison::~ResultComparison() = default;

std::optional<Divergence> ResultComparison::operator()(const StepResult& recorded, const StepResult& here) {
  if (auto d = buffers_->compare(here.step, "observables", recorded, here)) return d;
  if (recorded.events.size() != here.events.size()) {
    return Divergence{here.step,
                      {},
                      "events",
                      "count",
                      fmt::format("recorded {}, here {}", recorded.events.size(), here.events.size())};
  }
  for (std::size_t i = 0; i < here.events.size(); ++i) {
    if (auto d = buffers_->compare(here.step, "events", recorded.events[i], here.events[i])) {
      d->field = fmt::format("[{}]/{}", i, d->field);
      return d;
    }
  }
  return std::nullopt;
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

}  // namespace calot::recorder
