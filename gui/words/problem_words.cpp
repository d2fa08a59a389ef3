// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/problem_words.h"

#include <utility>

#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

/// Remedies of a window. The other remedies are the command line's.
constexpr std::pair<Remedy, const char*> advice[] = {
    {Remedy::replaceExisting, "choose another name, or allow it to be replaced"},
    {Remedy::recover, "what it holds up to there can be recovered"},
    {Remedy::moveFork, "choose another time"},
    {Remedy::measureCalibration, "measure its calibration again"},
    {Remedy::addParticipant, "add the participant first"},
    {Remedy::upgradeCohort, "open it alone, which brings it there and keeps a copy"},
    {Remedy::endReader, "end that program"},
    {Remedy::importAgain, "import its file again"},
    {Remedy::assessAgain, "import the older recordings again"},
    {Remedy::chooseKey, "choose one scene, device and version"},
    {Remedy::chooseAttemptRule, "choose which of a participant's attempts counts"},
    {Remedy::takeMean, "choose the mean of a participant's attempts"},
    {Remedy::exclude, "exclude one"},
    {Remedy::nameGroups, "choose two groups"},
};

}  // namespace

std::string problemText(const std::exception& error) {
  std::string text = error.what();
  const auto* known = dynamic_cast<const Error*>(&error);
  if (known == nullptr) return text;
  const char* between = "; ";
  for (const Remedy wanted : known->remedies()) {
    for (const auto& [remedy, words] : advice) {
      if (remedy != wanted) continue;
      text += std::string(between) + words;
      between = ", or ";
    }
  }
  return text;
}

}  // namespace calot::gui
