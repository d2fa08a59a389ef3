// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/compare.h"

#include <fmt/format.h>

#include <bit>

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

}  // namespace calot::recorder
