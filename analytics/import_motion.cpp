// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/import_motion.h"

#include <fmt/format.h>

#include <cassert>

#include "analytics/checkpoints/collector.h"
#include "analytics/external/metric_input.h"
#include "recorder/attempt.h"

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

/// Of custom content (version 8, RFC 9562): 122 bits of the hash.
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

}  // namespace calot::analytics
