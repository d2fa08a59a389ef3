// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/branch.h"

#include <fmt/format.h>

#include <cmath>

#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"
#include "recorder/engine/session.h"
#include "recorder/replay.h"
#include "sim/scene/version.h"

namespace calot::recorder {

void refuseParent(const Recording& parent, const ChainVerdict& chain) {
  const AttemptHeader& header = parent.header();
  const std::string name = parent.path().string();
  if (chain.intact && header.simulationVersion != simulationVersion) {
    throw Error(ErrorKind::undecided, Where{name},
                fmt::format("recorded with simulation version {}, this build has {}: it cannot be branched here",
                            header.simulationVersion, simulationVersion));
  }
  if (!chain.intact) throw Error(ErrorKind::refused, Where{name}, fmt::format("content chain broken: {}", chain.what));
  if (header.mode == Mode::assessment) {
    throw Error(ErrorKind::refused, Where{name}, "made in assessment mode, which has no branches");
  }
}

std::uint64_t forkStepAt(const Recording& parent, double time) {
  const AttemptHeader& header = parent.header();
  const double stepSeconds = header.tickSeconds * static_cast<double>(header.ticksPerStep);
  // A time that was written in decimals means the step's end that is next to it, not the one before.
  const double steps = std::floor(time / stepSeconds + 1e-6);
  if (!(steps >= 1.0)) {
    throw Error(ErrorKind::invalid, Where{parent.path().string(), fmt::format("fork at {} s", time)},
                fmt::format("it lies at the end of the first step, {} s, or later", stepSeconds), {Remedy::moveFork});
  }
  if (steps > static_cast<double>(parent.stepCount())) {
    throw Error(ErrorKind::invalid, Where{parent.path().string(), fmt::format("fork at {} s", time)},
                fmt::format("the recording ends at {} s", parent.seconds()), {Remedy::moveFork});
  }
  return static_cast<std::uint64_t>(steps) - 1;
}

AttemptHeader branchHeader(const Recording& parent, const Model& model, std::uint64_t forkStep,
                           const Provenance& provenance) {
  const AttemptHeader& from = parent.header();
  AttemptSettings settings = from;
  settings.mode = Mode::practice;
  AttemptHeader header = makeHeader(model, from.assets, provenance, settings);
  header.parent = from.attempt;
  header.forkStep = static_cast<std::int64_t>(forkStep);
  return header;
}

void takeParent(Recording& parent, Session& session, std::uint64_t forkStep,
                const std::function<void(std::uint64_t step, std::uint64_t of)>& progress) {
  LocalEngine engine(session);
  if (const auto divergence = follow(parent, engine, forkStep + 1, {}, progress)) {
    throw Error(ErrorKind::refused, Where{parent.path().string()}, describe(*divergence));
  }
}

BranchFile::BranchFile(std::filesystem::path target, bool force) : target_(std::move(target)), force_(force) {
  refuseOutput(target_, force_);
  temporary_ = target_;
  temporary_ += ".branch";
}

BranchFile::~BranchFile() {
  std::error_code ignored;
  if (!published_) std::filesystem::remove(temporary_, ignored);
}

void BranchFile::publish() {
  recorder::publish(temporary_, target_, force_);
  published_ = true;
}

}  // namespace calot::recorder
