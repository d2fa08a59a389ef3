// SPDX-License-Identifier: GPL-3.0-or-later
// Small recordings and a running QApplication for the dashboard's tests.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace calot::gui::test {

/// Records a performer on touch-liver with coarse organs, seen from shortly before the first touch on.
/// @return uuid of the attempt
std::string recordPerformer(const std::filesystem::path& file, double seconds, std::uint64_t seed = 3,
                            const std::string& purpose = "training");

/// A QApplication on the platform without screen, and settings in a folder that goes away.
void startApplication();

}  // namespace calot::gui::test
