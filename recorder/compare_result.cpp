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

}  // namespace calot::recorder
