// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"

namespace calot::apps {

/// Where the film of an attempt comes from.
struct FilmOrigin {
  std::string attempt;  ///< uuid
  std::filesystem::path file;
  bool isRecording = false;  ///< to be rendered
};

/// Films of attempts.
/// @param films a folder, in which a film has the uuid or the name of the recording or motion file (`.mp4`, `.mkv`,
/// `.webm`, `.mov`), and recordings without a film are rendered; or a CSV table with the columns `attempt` and `film`
/// @param chosen uuids or their beginnings; empty: every attempt that is not excluded, or every row of the table
/// @throws calot::Error (damaged) for an attempt without film, or a wrong row; (refused) for an attempt that is not
/// there
std::vector<FilmOrigin> findFilms(const analytics::CohortDatabase& cohort, const std::filesystem::path& films,
                                  const std::vector<std::string>& chosen);

}  // namespace calot::apps
