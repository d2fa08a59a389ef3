// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace calot::gui {

/// A name that no file of the folder has, for the recording of an attempt: "cholecystectomy-20260203T140500Z.h5", with
/// "-2" and so on behind the time where that is taken.
/// @param startUtc as headers have it: "2026-02-03T14:05:00Z"
[[nodiscard]] std::filesystem::path freshFile(const std::filesystem::path& folder, const std::string& scene,
                                              const std::string& startUtc);

}  // namespace calot::gui
