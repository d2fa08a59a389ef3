// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/checkpoints/replay_words.h"

#include <gtest/gtest.h>

#include "sim/scene/version.h"

namespace calot::analytics {
namespace {

using recorder::ReplayFinding;
using recorder::ReplayReport;
using recorder::ReplayVerdict;

ReplayReport compared(ReplayVerdict verdict) {
  ReplayReport report;
  report.finding = ReplayFinding::compared;
  report.verdict = verdict;
  report.chain.emplace();
  return report;
}

TEST(ReplayWords, SayWhatWasFound) {
  EXPECT_EQ(wordsFor(compared(ReplayVerdict::exact)), "bit-exact");
  ReplayReport report = compared(ReplayVerdict::diverged);
  report.divergence = {13, 137, "hand.right.input", "position", "index 0: recorded 1, here 2"};
  report.reproducible = true;
  EXPECT_EQ(wordsFor(report),
            "diverged at step 13, tick 137: hand.right.input position (index 0: recorded 1, here 2); reproducible: a "
            "second run differs in the same way");
  report.reproducible = false;
  report.chain = recorder::ChainVerdict{recorder::ChainFault::flush, 3, 50, 75, 0.5};
  const std::string broken =
      "the content chain is broken at flush 3 (steps 50 to 74, from 0.500 s on): what was recorded there was changed";
  EXPECT_EQ(wordsFor(report),
            "diverged at step 13, tick 137: hand.right.input position (index 0: recorded 1, here 2); not deterministic "
            "here: a second run behaves differently; content chain broken: " +
                broken);
  report.divergence.reset();
  EXPECT_EQ(wordsFor(report), "content chain broken: " + broken + " (the re-simulation agrees)");
  report.finding = ReplayFinding::otherNames;
  report.error = "structure 0 is called a, and by its scene b";
  EXPECT_EQ(wordsFor(report), "structure 0 is called a, and by its scene b; content chain broken: " + broken);
  report.finding = ReplayFinding::unread;
  EXPECT_EQ(wordsFor(report), "structure 0 is called a, and by its scene b; content chain broken: " + broken);
  report.chain.reset();
  EXPECT_EQ(wordsFor(report), "structure 0 is called a, and by its scene b");
  report.finding = ReplayFinding::otherLayout;
  EXPECT_EQ(wordsFor(report), "the recorded digests have other components than this build's State: nothing to compare");
}

TEST(ReplayWords, SayWhatWasNotLookedAt) {
  ReplayReport report = compared(ReplayVerdict::consistent);
  report.part = {{0, 1}, {0, 199}};
  EXPECT_EQ(wordsFor(report), "segments 0 to 1 consistent (steps 0 to 199); the rest was not looked at");
  report = compared(ReplayVerdict::undecided);
  report.simulationVersion = 7;
  EXPECT_EQ(wordsFor(report),
            "bit-exact; recorded with simulation version 7, this build has " + std::to_string(simulationVersion));
}

TEST(ReplayWords, SayWhatARunMissed) {
  EXPECT_EQ(wordsFor(recorder::StepMisses{}), "");
  EXPECT_EQ(wordsFor(recorder::StepMisses{2000, 17, 3, 14, 0}),
            "17 of 2000 steps missed a tolerance (solver 3, contact 14, held back 0)");
  EXPECT_EQ(wordsFor(recorder::Runaway{813, "liver", 21.5}),
            "step 813: the simulation of 'liver' ran away (21.5 m/s); the attempt ends here, keep the recording to "
            "find out why");
}

}  // namespace
}  // namespace calot::analytics
