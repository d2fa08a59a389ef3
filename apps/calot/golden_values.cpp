// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/golden_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <memory>

#include "analytics/checkpoints/collector.h"
#include "analytics/checkpoints/registry.h"
#include "analytics/report/report_text.h"
#include "recorder/base/errors.h"

namespace calot::apps {

namespace {

std::string shown(const GoldenValue& v) {
  const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(v.name);
  if (definition == nullptr) return fmt::format("{}", v.value);
  return fmt::format("{} {}", analytics::significant(v.value * definition->displayFactor, 8), definition->displayUnit);
}

const GoldenValue* sameOf(const std::vector<GoldenValue>& values, const GoldenValue& of) {
  const auto found = std::find_if(values.begin(), values.end(),
                                  [&](const GoldenValue& v) { return v.name == of.name && v.subject == of.subject; });
  return found == values.end() ? nullptr : &*found;
}

std::string titleOf(const GoldenValue& v) { return v.subject.empty() ? v.name : v.name + " " + v.subject; }

bool sameBits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

}  // namespace

std::vector<GoldenValue> goldenValues(const std::vector<analytics::CheckpointValue>& values) {
  std::vector<GoldenValue> kept;
  for (const analytics::CheckpointValue& v : values) {
    if (v.value) kept.push_back({v.name, v.subject, v.version, *v.value});
  }
  return kept;
}

std::vector<std::string> changedValues(const std::vector<GoldenValue>& before, const std::vector<GoldenValue>& now) {
  std::vector<std::string> lines;
  for (const GoldenValue& b : before) {
    const GoldenValue* n = sameOf(now, b);
    if (n == nullptr) {
      lines.push_back(fmt::format("{}: {} -> none", titleOf(b), shown(b)));
    } else if (!sameBits(n->value, b.value)) {
      const std::string why =
          n->version == b.version ? "" : fmt::format(" (definition version {} -> {})", b.version, n->version);
      lines.push_back(fmt::format("{}: {} -> {}{}", titleOf(b), shown(b), shown(*n), why));
    }
  }
  for (const GoldenValue& n : now) {
    if (sameOf(before, n) == nullptr) lines.push_back(fmt::format("{}: none -> {}", titleOf(n), shown(n)));
  }
  return lines;
}

GoldenReplay replayGolden(const std::filesystem::path& file, const GoldenEntry& entry, unsigned threads) {
  GoldenReplay replay;
  std::unique_ptr<analytics::CheckpointCollector> collector;
  recorder::ReplaySettings settings;
  settings.threads = threads;
  settings.observers = [&](const recorder::AttemptHeader& h, const SceneDescription& scene) {
    collector = std::make_unique<analytics::CheckpointCollector>(h, scene);
    return std::vector<recorder::Observer*>{collector.get()};
  };
  replay.report = recorder::replayRecording(file, settings);
  if (replay.report.verdict != recorder::ReplayVerdict::exact) return replay;
  replay.values = goldenValues(collector->values());
  replay.changed = changedValues(entry.values, replay.values);
  if (replay.changed.empty()) return replay;
  // The simulation is the same; what is computed over it is not.
  replay.report.verdict = recorder::ReplayVerdict::diverged;
  replay.report.message =
      fmt::format("bit-exact, but {} checkpoints have other values: {}", replay.changed.size(), replay.changed.front());
  return replay;
}

void refuseValues(const GoldenEntry& entry, const std::vector<GoldenValue>& now) {
  for (const GoldenValue& before : entry.values) {
    const GoldenValue* after = sameOf(now, before);
    const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(before.name);
    if (after != nullptr ? sameBits(after->value, before.value) || after->version > before.version
                         : definition == nullptr || definition->version > before.version)
      continue;
    throw Error(ErrorKind::refused,
                fmt::format("golden: {}: {} has another value ({} -> {}) and still definition version "
                            "{}: raise the version or mend the checkpoint",
                            entry.file, titleOf(before), shown(before), after == nullptr ? "none" : shown(*after),
                            before.version));
  }
}

}  // namespace calot::apps
