// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/replay_words.h"

#include <fmt/format.h>

#include "sim/scene/version.h"

namespace calot::analytics {

using recorder::ChainFault;
using recorder::ReplayFinding;

std::string wordsFor(const recorder::StepMisses& misses) {
  if (misses.any == 0) return {};
  return fmt::format("{} of {} steps missed a tolerance (solver {}, contact {}, held back {})", misses.any,
                     misses.steps, misses.solver, misses.contact, misses.heldBack);
}

std::string wordsFor(const recorder::Runaway& runaway) {
  return fmt::format(
      "step {}: the simulation of '{}' ran away ({:.3g} m/s); the attempt ends here, keep the recording to find out "
      "why",
      runaway.step, runaway.structure, runaway.speed);
}

std::string wordsFor(const recorder::Divergence& divergence) {
  std::string text = fmt::format("diverged at step {}", divergence.step);
  if (divergence.tick) text += fmt::format(", tick {}", *divergence.tick);
  text += fmt::format(": {} {}", divergence.component, divergence.field);
  if (!divergence.detail.empty()) text += fmt::format(" ({})", divergence.detail);
  return text;
}

std::string wordsFor(const recorder::ChainVerdict& chain) {
  switch (chain.fault) {
    case ChainFault::none:
      return {};
    case ChainFault::start:
      return "the content chain is broken at its start: root attributes, scene or names were changed";
    case ChainFault::flush:
      return fmt::format(
          "the content chain is broken at flush {} (steps {} to {}, from {:.3f} s on): what was recorded there was "
          "changed",
          chain.flush, chain.firstStep, chain.endStep - 1, chain.seconds);
    case ChainFault::signature:
      return "the signature does not fit the content: one of both was changed after it was signed";
  }
  return {};
}

void refuseBrokenParent(const std::filesystem::path& parent, const recorder::ChainVerdict& chain) {
  if (chain.intact()) return;
  throw Error(ErrorKind::refused, Where{parent.string()}, "content chain broken: " + wordsFor(chain));
}

std::string wordsFor(const recorder::ReplayReport& report) {
  const std::string broken =
      !report.chain || report.chainIntact() ? "" : "content chain broken: " + wordsFor(*report.chain);
  std::string text = "bit-exact";
  if (report.finding == ReplayFinding::unread || report.finding == ReplayFinding::otherNames) {
    text = report.error;
  } else if (report.finding == ReplayFinding::otherLayout) {
    text = "the recorded digests have other components than this build's State: nothing to compare";
  } else if (report.divergence) {
    text = wordsFor(*report.divergence) + (*report.reproducible
                                               ? "; reproducible: a second run differs in the same way"
                                               : "; not deterministic here: a second run behaves differently");
  } else if (!broken.empty()) {
    return broken + " (the re-simulation agrees)";
  } else if (report.part) {
    text =
        fmt::format("segments {} to {} consistent (steps {} to {}); the rest was not looked at",
                    report.part->segments[0], report.part->segments[1], report.part->steps[0], report.part->steps[1]);
  }
  if (!broken.empty()) text += "; " + broken;
  if (report.verdict == recorder::ReplayVerdict::undecided && report.finding == ReplayFinding::compared)
    text += fmt::format("; recorded with simulation version {}, this build has {}", report.simulationVersion,
                        simulationVersion);
  return text;
}

}  // namespace calot::analytics
