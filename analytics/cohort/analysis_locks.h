// SPDX-License-Identifier: GPL-3.0-or-later
// Masked groups and locked analyses of protocols (schemas/cohort/0007_blinding.sql).
#pragma once

#include <optional>
#include <string>

namespace calot::analytics {

/// An analysis as it stood when it was locked, after which its groups are named.
struct AnalysisLock {
  std::string protocolSha256;
  std::string protocol;      ///< name and version
  std::string options;       ///< analysisOptions()
  std::string valuesSha256;  ///< analysisDigest()
  std::string software;
  std::string lockedUtc, by;
};

/// True if the protocol's second population is "group 1"; none: never masked. @throws Error as CohortDatabase
std::optional<bool> readGroupMask(const std::string& path, const std::string& protocolSha256);
/// The same, drawn from the system's source of randomness and stored where there is none yet; audited.
bool drawGroupMask(const std::string& path, const std::string& protocolSha256);

std::optional<AnalysisLock> readAnalysisLock(const std::string& path, const std::string& protocolSha256);
/// Stores a lock with the present time, audited; one that is there stays and is returned. @param[out] added whether it
/// is new. @throws Error (invalid) where nobody locks it
AnalysisLock storeAnalysisLock(const std::string& path, const AnalysisLock& lock, bool& added);

}  // namespace calot::analytics
