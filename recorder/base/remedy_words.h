// SPDX-License-Identifier: GPL-3.0-or-later
// Words for remedies, shared by the programs that people and scripts use without a window.
#pragma once

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "recorder/base/errors.h"

namespace calot {

/// A remedy, and how a program phrases it.
struct RemedyWords {
  Remedy remedy;
  const char* words;
};

/// Remedies that are a command of calot, whichever program reports the error.
inline constexpr RemedyWords remedyCommands[] = {
    {Remedy::recover, "calot recover saves what it can"},
    {Remedy::installEngine, "calot engine list shows those that are there"},
    {Remedy::measureCalibration, "measure again with calot devices calibrate"},
    {Remedy::listDevices, "calot devices lists what there is"},
    {Remedy::addParticipant, "register one with calot participant add"},
    {Remedy::changeParticipant, "change it with calot participant set"},
    {Remedy::upgradeCohort, "bring it there with calot cohort upgrade, which keeps a copy"},
    {Remedy::endReader, "end that program and run calot cohort scrub"},
    {Remedy::nameCohort, "make one with calot cohort name"},
    {Remedy::importAgain, "run calot import on its file"},
    {Remedy::rateAttempts, "rate one with calot rate"},
    {Remedy::assessAgain, "assess the older recordings again"},
    {Remedy::exclude, "exclude one with calot attempt exclude"},
};

/// "do this, or that": each remedy in the program's own words, else as a command; one without words is left out.
inline std::string adviceText(const std::vector<Remedy>& remedies, std::span<const RemedyWords> own) {
  std::string text;
  for (const Remedy remedy : remedies) {
    for (const std::span<const RemedyWords> table : {own, std::span<const RemedyWords>(remedyCommands)}) {
      const auto found = std::find_if(table.begin(), table.end(), [&](const auto& w) { return w.remedy == remedy; });
      if (found == table.end()) continue;
      text += std::string(text.empty() ? "" : ", or ") + found->words;
      break;
    }
  }
  return text;
}

}  // namespace calot
