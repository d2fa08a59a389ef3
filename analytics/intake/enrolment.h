// SPDX-License-Identifier: GPL-3.0-or-later
// Registering participants from a table: what a cohort knows of them is never replaced.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/intake/motion_manifest.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

/// A cohort's participants when this was made, and those added through it.
class Enrolment {
 public:
  explicit Enrolment(const CohortDatabase& database);

  /// Adds a participant, or fills what the cohort has empty; nothing and no audit row where there is nothing new.
  /// @param database that of the constructor. @throws Error (refused) where the cohort says something else of the
  /// participant; as CohortDatabase.
  void add(CohortDatabase& database, const Participant& wanted);

  /// A manifest's participants that the cohort describes in another way, each naming the line.
  [[nodiscard]] std::vector<Error> conflicts(const MotionManifest& manifest) const;

 private:
  [[nodiscard]] ParticipantChange changeOf(const Participant& wanted) const;

  std::string path_;
  std::map<std::string, Participant> known_;
};

}  // namespace calot::analytics
