// SPDX-License-Identifier: GPL-3.0-or-later
// The files of a participant who withdraws: which there are in a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analytics/cohort/withdraw.h"

namespace calot::analytics {

struct WithdrawalFiles {
  /// Recordings of the attempts and of branches of them, also damaged ones that name one; with scope `all`, every
  /// recording of the participant. Then pictures and films beside these, of the same name.
  std::vector<std::filesystem::path> remove;
  /// Other files that are about them: any in whose bytes an attempt's uuid stands; with scope `all`, text in which the
  /// pseudonym stands as a value of its own, files that are called so, and cohort databases that have the participant.
  /// A recording is of whom it says that it is of: its bytes are not searched.
  std::vector<std::filesystem::path> naming;
  /// uuids of the recordings to remove that the database does not know.
  std::vector<std::string> unknown;
};

/// Looks through every file of the folders and below, byte for byte. Changes nothing.
/// @param keep files to leave out: the database, the key file
/// @throws Error damaged: a folder is not there
WithdrawalFiles findFiles(const Withdrawal& withdrawal, const std::string& database,
                          const std::vector<std::filesystem::path>& folders,
                          const std::vector<std::filesystem::path>& keep);

}  // namespace calot::analytics
