// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/common/advice.h"

namespace calot::apps {
namespace {

const char* adviceOf(Remedy remedy) {
  switch (remedy) {
    case Remedy::replaceExisting:
      return "--force replaces what is there";
    case Remedy::recover:
      return "calot recover saves what it can";
    case Remedy::installEngine:
      return "calot engine list shows those that are there";
    case Remedy::replayAnyway:
      return "--anyway repeats it all the same, and says so";
    case Remedy::moveFork:
      return "move it with --at";
    case Remedy::measureCalibration:
      return "measure again with calot devices calibrate";
    case Remedy::listDevices:
      return "calot devices lists what there is";
    case Remedy::nameDevice:
      return "name another with --device";
    case Remedy::nameTools:
      return "name them with --tools LEFT,RIGHT";
    case Remedy::addParticipant:
      return "register one with calot participant add";
    case Remedy::changeParticipant:
      return "change it with calot participant set";
    case Remedy::upgradeCohort:
      return "bring it there with calot cohort upgrade, which keeps a copy";
    case Remedy::emptyLog:
      return "end that program and run calot cohort scrub";
    case Remedy::nameCohort:
      return "make one with calot cohort name";
    case Remedy::importAgain:
      return "run calot import on its file";
    case Remedy::rateAttempts:
      return "rate one with calot rate";
    case Remedy::assessAgain:
      return "assess the older recordings again";
    case Remedy::chooseKey:
      return "choose one with --key";
    case Remedy::mixKeys:
      return "compare all the same with --mix-keys";
    case Remedy::chooseAttemptRule:
      return "declare --attempt-rule first or mean";
    case Remedy::takeFirst:
      return "take --attempt-rule first";
    case Remedy::takeMean:
      return "take --attempt-rule mean";
    case Remedy::exclude:
      return "exclude one with calot attempt exclude";
    case Remedy::chooseOccasion:
      return "choose one occasion (--occasion-column, --occasion)";
    case Remedy::nameParticipantColumn:
      return "name it with --participant-column";
    case Remedy::nameGroupColumn:
      return "name it with --group-column";
    case Remedy::nameOccasionColumn:
      return "name it with --occasion-column";
    case Remedy::nameOccasion:
      return "name it with --occasion";
    case Remedy::nameOutcome:
      return "name one with --outcome";
    case Remedy::nameGroups:
      return "name two with --groups A,B";
    case Remedy::nameBetterGroup:
      return "name one with --better";
    case Remedy::nameFamily:
      return "name rows of the study with --family";
    case Remedy::nameCheckpoints:
      return "name others with --checkpoints";
  }
  return "";
}

}  // namespace

std::string advice(const std::vector<Remedy>& remedies) {
  std::string text;
  for (const Remedy remedy : remedies) text += std::string(text.empty() ? "" : ", or ") + adviceOf(remedy);
  return text;
}

std::string advised(const std::string& message, const std::vector<Remedy>& remedies) {
  return remedies.empty() ? message : message + "; " + advice(remedies);
}

std::string messageOf(const Error& error) { return advised(error.what(), error.remedies()); }

}  // namespace calot::apps
