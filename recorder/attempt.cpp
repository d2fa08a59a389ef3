// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/attempt.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sodium.h>

#include <chrono>
#include <thread>

#include "sim/scene/version.h"

#ifndef CALOT_VERSION
#error "CALOT_VERSION is set by the build"
#endif

namespace calot::recorder {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto longestLag = std::chrono::milliseconds(100);

/// Random uuid (RFC 4122, version 4).
std::string makeUuid() {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be initialised");
  std::array<unsigned char, 16> b{};
  randombytes_buf(b.data(), b.size());
  b[6] = static_cast<unsigned char>((b[6] & 0x0FU) | 0x40U);
  b[8] = static_cast<unsigned char>((b[8] & 0x3FU) | 0x80U);
  std::string text;
  for (std::size_t i = 0; i < b.size(); ++i) {
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += fmt::format("{:02x}", b[i]);
  }
  return text;
}

double seconds(Clock::duration d) { return std::chrono::duration<double>(d).count(); }

}  // namespace

std::string softwareName() { return "calot " CALOT_VERSION; }

std::string buildName() {
  std::string compiler;
#if defined(__clang__)
  compiler = fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  compiler = fmt::format("gcc {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
  return fmt::format("{} {} {}", compiler, CALOT_BUILD_TYPE, CALOT_REVISION);
}

AttemptHeader makeHeader(const Model& model, std::vector<Asset> assets, const Provenance& provenance,
                         const AttemptSettings& settings) {
  AttemptHeader header;
  header.attempt = makeUuid();
  header.startUtc = fmt::format("{:%Y-%m-%dT%H:%M:%S}Z",
                                fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
  header.software = softwareName();
  header.build = buildName();
  header.simulationVersion = simulationVersion;
  header.stepResultVersion = stepResultVersion;
  header.participant = settings.participant;
  header.provenance = provenance;
  header.station = settings.station;
  header.mode = settings.mode;
  header.purpose = settings.purpose;
  header.handedness = settings.handedness;
  header.seed = settings.seed;
  header.ticksPerStep = model.scene().ticksPerStep;
  header.sceneName = model.scene().name;
  header.sceneMajor = model.scene().majorVersion;
  header.sceneMinor = model.scene().minorVersion;
  header.assets = std::move(assets);
  for (const OrganModel& organ : model.organs()) header.organs.push_back(organ.name);
  header.layout = model.layout();
  return header;
}

RunReport runAttempt(Session& session, SampleSource& source, const RunSettings& settings) {
  const std::uint32_t ticksPerStep = session.model().scene().ticksPerStep;
  const double timeLimit = session.model().scene().timeLimit;
  std::vector<TickSamples> samples(ticksPerStep);
  std::vector<TickOutcome> ticks(ticksPerStep);
  RunReport report;
  const Clock::time_point begin = Clock::now();
  Clock::time_point origin = begin;  // when tick 0 was due
  constexpr auto tickDuration = std::chrono::milliseconds(1);
  bool open = true;
  for (std::uint64_t tick = 0; open;) {
    const double time = static_cast<double>(session.steps()) * session.model().stepSeconds();
    if (timeLimit > 0.0 && time >= timeLimit) {
      report.outcome = Outcome::timeLimit;
      break;
    }
    if ((settings.seconds > 0.0 && time >= settings.seconds) || (settings.stop != nullptr && settings.stop->load())) {
      report.outcome = Outcome::stopped;
      break;
    }
    for (std::uint32_t i = 0; i < ticksPerStep && open; ++i, ++tick) {
      open = source.next(tick, samples[i]);
      if (!open) break;
      float lateness = 0.0F;
      if (settings.paced) {
        const Clock::time_point due = origin + static_cast<Clock::rep>(tick) * tickDuration;
        std::this_thread::sleep_until(due);
        const auto late = Clock::now() - due;
        lateness = static_cast<float>(seconds(late));
        report.largestLateness = std::max(report.largestLateness, seconds(late));
        if (late > tickDuration) ++report.lateTicks;
        if (late > longestLag) {
          origin += late;
          report.stretched += seconds(late);
        }
      }
      ticks[i] = session.tick(samples[i]);
      ticks[i].lateness = lateness;
    }
    if (!open) break;
    // A step is due when the next one's first tick is.
    const float late = settings.paced
                           ? static_cast<float>(std::max(
                                 0.0, seconds(Clock::now() - (origin + static_cast<Clock::rep>(tick) * tickDuration))))
                           : 0.0F;
    session.step(samples, ticks, late);
    if (settings.progress) settings.progress(session.steps());
  }
  report.steps = session.steps();
  session.end(report.outcome);
  report.wallSeconds = seconds(Clock::now() - begin);
  return report;
}

}  // namespace calot::recorder
