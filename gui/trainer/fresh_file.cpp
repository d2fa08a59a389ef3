// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/fresh_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace calot::gui {

std::filesystem::path freshFile(const std::filesystem::path& folder, const std::string& scene,
                                const std::string& startUtc) {
  std::string when;
  std::copy_if(startUtc.begin(), startUtc.end(), std::back_inserter(when), [](char c) { return c != '-' && c != ':'; });
  const std::string stem = fmt::format("{}-{}", scene, when);
  std::filesystem::path file = folder / (stem + ".h5");
  for (int n = 2; std::filesystem::exists(file); ++n) file = folder / fmt::format("{}-{}.h5", stem, n);
  return file;
}

}  // namespace calot::gui
