// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/import_motion.h"

#include <fmt/format.h>

#include <cassert>
#include <initializer_list>
#include <utility>

#include "analytics/checkpoints/collector.h"
#include "analytics/external/metric_input.h"
#include "recorder/base/dates.h"
#include "recorder/loop.h"

namespace calot::analytics {
namespace {

std::array<std::byte, 32> bytesOf(const std::string& hexadecimal) {
  assert(hexadecimal.size() == 64);
  const auto digit = [](char c) { return static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10); };
  std::array<std::byte, 32> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::byte>(digit(hexadecimal[2 * i]) * 16U + digit(hexadecimal[2 * i + 1]));
  return bytes;
}

/// Custom content (version 8, RFC 9562): 122 bits of the hash.
std::string uuidOf(std::array<std::byte, 32> hash) {
  hash[6] = (hash[6] & std::byte{0x0f}) | std::byte{0x80};
  hash[8] = (hash[8] & std::byte{0x3f}) | std::byte{0x80};
  std::string uuid;
  for (std::size_t i = 0; i < 16; ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) uuid += '-';
    uuid += fmt::format("{:02x}", static_cast<unsigned>(hash[i]));
  }
  return uuid;
}

}  // namespace

AttemptRecord recordOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration) {
  AttemptRecord a;
  a.chainHead = bytesOf(motion.sha256);
  a.uuid = uuidOf(a.chainHead);
  a.participant = declaration.participant;
  a.scene = declaration.task;
  a.operatorKind = recorder::OperatorKind::kinematics;
  a.mode = declaration.mode;
  a.purpose = declaration.purpose;
  a.outcome = declaration.outcome;
  a.startUtc = declaration.startUtc;
  a.device = motion.device;
  a.calibration = motion.frame.empty() ? std::string() : "frame-" + motion.frame;
  a.fileName = motion.file;
  a.complete = true;
  a.steps = motion.time.size() - 1;
  a.stepSeconds = motion.time.back() / static_cast<double>(a.steps);
  a.verification = {Verdict::notCheckableHere, "motion without a scene: there is nothing to simulate again",
                    recorder::softwareName()};
  recorder::AttemptHeader header;
  header.sceneName = a.scene;
  header.mode = a.mode;
  header.provenance.kind = a.operatorKind;
  header.provenance.device = a.device;
  header.provenance.calibration = a.calibration;
  a.comparabilityKey = comparabilityKey(header);
  return a;
}

StoredMotion storeMotion(CohortDatabase& database, const recorder::TrackedMotion& motion,
                         const MotionDeclaration& declaration) {
  StoredMotion stored;
  stored.values = valuesFromSamples(motion, {declaration.outcome, declaration.handedness, motionCutoff});
  stored.imported = database.storeAttempt(recordOf(motion, declaration), stored.values);
  return stored;
}

MetricOutcomes externalOf(const recorder::TrackedMotion& motion, const MotionDeclaration& declaration,
                          const std::vector<MetricScript>& metrics) {
  if (metrics.empty()) return {};
  const TemporaryFolder input = writeMetricInput(motion, declaration.outcome, declaration.handedness, declaration.task);
  return computeMetrics(metrics, input.path());
}

namespace {

/// Sets `out` to the meaning of a word. @return empty, or the words that there are
template <class T>
std::string choose(T& out, const std::string& word, std::initializer_list<std::pair<const char*, T>> words) {
  std::string known;
  for (const auto& [name, meaning] : words) {
    if (word == name) {
      out = meaning;
      return {};
    }
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  return known + " is expected";
}

std::string setTask(std::string& task, const std::string& word) {
  if (word.size() > 60) return "1 to 60 characters are expected";
  for (const char c : word) {
    if (c <= ' ' || c > '~') return "a word without blanks is expected";
  }
  task = word;
  return {};
}

}  // namespace

std::string declareMotion(MotionDeclaration& d, std::string_view field, const std::string& word) {
  using recorder::Mode, recorder::Outcome;
  if (word.empty()) return {};
  if (field == "task") return setTask(d.task, word);
  if (field == "mode")
    return choose<Mode>(d.mode, word, {{"practice", Mode::practice}, {"assessment", Mode::assessment}});
  if (field == "purpose")
    return choose<std::string>(d.purpose, word, {{"training", "training"}, {"study", "study"}, {"demo", "demo"}});
  if (field == "handedness")
    return choose<std::string>(d.handedness, word, {{"right", "right"}, {"left", "left"}, {"unknown", "unknown"}});
  if (field == "outcome") {
    return choose<Outcome>(
        d.outcome, word,
        {{"completed", Outcome::completed}, {"abandoned", Outcome::abandoned}, {"stopped", Outcome::stopped}});
  }
  if (field == "start") {
    if (!recorder::isDate(word)) return "2026-01-31T12:00:00Z is expected";
    d.startUtc = word;
    return {};
  }
  assert(field == "participant");
  if (word.size() > 64) return "longer than 64 characters";
  d.participant = word;
  return {};
}

}  // namespace calot::analytics
