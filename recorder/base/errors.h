// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace calot {

enum class ErrorKind : std::uint8_t {
  failure,    ///< the machine: disk full, no memory, a device that is gone, another program in the way
  invalid,    ///< the request: a name, a value or an output that cannot be
  refused,    ///< the answer is no: it contradicts what is stored, does not compare, or is not allowed
  damaged,    ///< the input: damaged, unreadable or missing
  undecided,  ///< this build cannot decide: the input is of another version
};

/// Remedies of an error. Programs phrase them: a flag, a command, a control of a window.
enum class Remedy : std::uint8_t {
  replaceExisting,        ///< ask for what is there to be replaced
  recover,                ///< save what a recording that is cut off still holds
  installEngine,          ///< install the engine of the recording's simulation version
  replayAnyway,           ///< replay a recording of another simulation version, and report
  moveFork,               ///< choose another time for the fork of a branch
  measureCalibration,     ///< calibrate the device again
  listDevices,            ///< see which devices there are
  nameDevice,             ///< name a device that can be opened
  nameTools,              ///< name the tools of an OpenIGTLink server, one for each hand
  addParticipant,         ///< register the participant first
  changeParticipant,      ///< change the entry that is there
  upgradeCohort,          ///< bring the cohort database to the schema of this version
  endReader,              ///< end the other program, then overwrite what was deleted
  nameCohort,             ///< make the named cohort
  importAgain,            ///< import the file of a motion again
  rateAttempts,           ///< rate attempts with the form
  assessAgain,            ///< assess the older recordings again
  chooseKey,              ///< choose one comparability key
  mixKeys,                ///< compare what does not compare
  chooseAttemptRule,      ///< declare which of a participant's attempts counts: the first, or the mean
  takeFirst,              ///< take the first attempt of each participant
  takeMean,               ///< take the mean of each participant's attempts
  exclude,                ///< exclude one of the attempts
  chooseOccasion,         ///< choose one occasion, by the column that names occasions
  nameParticipantColumn,  ///< say which column names the participant
  nameGroupColumn,        ///< say which column names the group
  nameOccasionColumn,     ///< say which column names the occasion
  nameOccasion,           ///< say which occasion is compared with the baseline
  nameOutcome,            ///< name an outcome among the columns
  nameGroups,             ///< name two groups
  nameBetterGroup,        ///< say which group is expected to do better
  nameFamily,             ///< name rows of the study as the family of hypotheses
  nameCheckpoints,        ///< name figures that judge
  sayNames,               ///< say whether similar names are one or two
  sayDates,               ///< say whether day or month comes first in dates
  sayZone,                ///< say which zone times are of
};

struct Where {
  std::string file;        ///< a file, folder or database, as it was named
  std::string place = {};  ///< in the file: "/observables", "line 3"; may be empty
};

/// Bad input or a failed operation, found at the edge. what() is one line, "file: place: fault", as far as there are
/// such; what a program advises (remedies) and answers with (an exit code, a dialog) is its own matter.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, Where where, const std::string& fault, std::initializer_list<Remedy> remedies = {})
      : Error(kind, std::move(where), fault, std::vector<Remedy>(remedies)) {}
  Error(ErrorKind kind, const std::string& fault, std::initializer_list<Remedy> remedies = {})
      : Error(kind, Where{}, fault, remedies) {}
  Error(ErrorKind kind, Where where, const std::string& fault, std::vector<Remedy> remedies)
      : std::runtime_error(line(where, fault)),
        kind_(kind),
        where_(std::move(where)),
        fault_(fault),
        remedies_(std::move(remedies)) {}

  [[nodiscard]] ErrorKind kind() const { return kind_; }
  [[nodiscard]] const Where& where() const { return where_; }
  [[nodiscard]] const std::string& fault() const { return fault_; }  ///< the message without file and place
  /// Each of them resolves it; the first is the most likely.
  [[nodiscard]] const std::vector<Remedy>& remedies() const { return remedies_; }

 private:
  static std::string line(const Where& where, const std::string& fault) {
    std::string text;
    if (!where.file.empty()) text += where.file + ": ";
    if (!where.place.empty()) text += where.place + ": ";
    return text + fault;
  }

  ErrorKind kind_;
  Where where_;
  std::string fault_;
  std::vector<Remedy> remedies_;
};

}  // namespace calot
