// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/words/problem_words.h"

#include "recorder/base/errors.h"

namespace calot::gui {
namespace {

/// Empty: nothing that is done in a window.
const char* adviceOf(Remedy remedy) {
  switch (remedy) {
    case Remedy::replaceExisting:
      return "choose another name, or allow it to be replaced";
    case Remedy::recover:
      return "what it holds can be recovered on the command line";
    case Remedy::moveFork:
      return "choose another time";
    case Remedy::measureCalibration:
      return "measure its calibration again";
    case Remedy::addParticipant:
      return "add the participant first";
    case Remedy::upgradeCohort:
      return "open it alone, which brings it there and keeps a copy";
    case Remedy::emptyLog:
      return "end that program";
    case Remedy::importAgain:
      return "import its file again";
    case Remedy::assessAgain:
      return "import the older recordings again";
    case Remedy::chooseKey:
      return "choose one scene, device and version";
    case Remedy::chooseAttemptRule:
      return "choose which of a participant's attempts counts";
    case Remedy::takeMean:
      return "choose the mean of a participant's attempts";
    case Remedy::exclude:
      return "exclude one";
    case Remedy::nameGroups:
      return "choose two groups";
    case Remedy::installEngine:
    case Remedy::replayAnyway:
    case Remedy::listDevices:
    case Remedy::nameDevice:
    case Remedy::nameTools:
    case Remedy::changeParticipant:
    case Remedy::nameCohort:
    case Remedy::rateAttempts:
    case Remedy::mixKeys:
    case Remedy::takeFirst:
    case Remedy::chooseOccasion:
    case Remedy::nameParticipantColumn:
    case Remedy::nameGroupColumn:
    case Remedy::nameOccasionColumn:
    case Remedy::nameOccasion:
    case Remedy::nameOutcome:
    case Remedy::nameBetterGroup:
    case Remedy::nameFamily:
    case Remedy::nameCheckpoints:
      break;
  }
  return "";
}

}  // namespace

std::string problemText(const std::exception& error) {
  std::string text = error.what();
  const auto* known = dynamic_cast<const Error*>(&error);
  if (known == nullptr) return text;
  const char* between = "; ";
  for (const Remedy remedy : known->remedies()) {
    const std::string advice = adviceOf(remedy);
    if (advice.empty()) continue;
    text += between + advice;
    between = ", or ";
  }
  return text;
}

}  // namespace calot::gui
