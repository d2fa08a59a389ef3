// SPDX-License-Identifier: GPL-3.0-or-later

#include "apps/common/program.h"

#include <algorithm>
#include <exception>
#include <iostream>
#include <new>

#include "recorder/base/remedy_words.h"

namespace calot::apps {
namespace {

/// Remedies that are an option of a command.
constexpr RemedyWords remedyOptions[] = {
    {Remedy::replaceExisting, "--force replaces what is there"},
    {Remedy::replayAnyway, "--anyway repeats it all the same, and says so"},
    {Remedy::moveFork, "move it with --at"},
    {Remedy::nameDevice, "name another with --device"},
    {Remedy::nameTools, "name them with --tools LEFT,RIGHT"},
    {Remedy::chooseKey, "choose one with --key"},
    {Remedy::mixKeys, "compare all the same with --mix-keys"},
    {Remedy::chooseAttemptRule, "declare --attempt-rule first or mean"},
    {Remedy::takeFirst, "take --attempt-rule first"},
    {Remedy::takeMean, "take --attempt-rule mean"},
    {Remedy::chooseOccasion, "choose one occasion (--occasion-column, --occasion)"},
    {Remedy::nameParticipantColumn, "name it with --participant-column"},
    {Remedy::nameGroupColumn, "name it with --group-column"},
    {Remedy::nameOccasionColumn, "name it with --occasion-column"},
    {Remedy::nameOccasion, "name it with --occasion"},
    {Remedy::nameOutcome, "name one with --outcome"},
    {Remedy::nameGroups, "name two with --groups A,B"},
    {Remedy::nameBetterGroup, "name one with --better"},
    {Remedy::nameFamily, "name rows of the study with --family"},
    {Remedy::nameCheckpoints, "name others with --checkpoints"},
};

}  // namespace

ExitCode codeOf(ErrorKind kind) {
  static_assert(static_cast<int>(ErrorKind::undecided) + 1 == static_cast<int>(ExitCode::undecided));
  return static_cast<ExitCode>(static_cast<int>(kind) + 1);  // both lists have one order
}

ExitCode codeOf(const std::optional<ErrorKind>& fault) { return fault ? codeOf(*fault) : ExitCode::yes; }

ExitCode worstOf(const std::vector<ExitCode>& codes) {
  for (const ExitCode code : {ExitCode::failure, ExitCode::damaged, ExitCode::no, ExitCode::undecided}) {
    if (std::find(codes.begin(), codes.end(), code) != codes.end()) return code;
  }
  return ExitCode::yes;
}

int endWith(ExitCode code, const std::string& program, const std::string& message) {
  std::cerr << program << ": " << message << '\n';
  return static_cast<int>(code);
}

int runProgram(const std::string& program, const std::function<int()>& body) {
  try {
    return body();
  } catch (const Error& e) {
    return endWith(codeOf(e.kind()), program, messageOf(e));
  } catch (const std::bad_alloc&) {
    return endWith(ExitCode::failure, program, "not enough memory");
  } catch (const std::exception& e) {
    return endWith(ExitCode::failure, program, e.what());
  }
}

std::string advice(const std::vector<Remedy>& remedies) { return adviceText(remedies, remedyOptions); }

std::string advised(const std::string& message, const std::vector<Remedy>& remedies) {
  return remedies.empty() ? message : message + "; " + advice(remedies);
}

std::string messageOf(const Error& error) { return advised(error.what(), error.remedies()); }

}  // namespace calot::apps
