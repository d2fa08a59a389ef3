// SPDX-License-Identifier: GPL-3.0-or-later
// Moments of a recording: the step that each lies in, and its picture for a sheet.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "analytics/report/attempt_sheet.h"
#include "recorder/recording/reader.h"
#include "recorder/replay.h"

namespace calot::gui {

/// The step that a moment (s since the attempt's start, clamped) lies in. @pre the recording has a step
[[nodiscard]] std::uint64_t stepAt(const recorder::Recording& recording, double time);

/// Makes a step the seeker's last one. @throws Error (refused) where another operation than the recorded one came
void seekAsRecorded(recorder::Seeker& seeker, const recorder::Recording& recording, std::uint64_t step);

/// The moments as the pictures of a sheet, drawn in software: the same bytes each time.
/// @param moments by time @param progress called after every picture; an exception from it ends the work
/// @throws calot::Error: as the recording's; refused as seekAsRecorded(); undecided where no engine of its version is
/// here; failure where nothing can be drawn
std::vector<analytics::Picture> sheetPictures(
    const std::filesystem::path& file, const std::vector<analytics::SheetMoment>& moments,
    const std::function<void(std::uint64_t done, std::uint64_t of)>& progress = {});

}  // namespace calot::gui
