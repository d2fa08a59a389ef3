// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/program_files.h"

#include <cstdlib>
#include <system_error>
#include <utility>

namespace calot::recorder {

ProgramFiles::ProgramFiles(std::filesystem::path programs) : programs_(std::move(programs)) {}

ProgramFiles ProgramFiles::ofThisProgram() {
  std::error_code ignored;
  return ProgramFiles(std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path());
}

std::vector<std::filesystem::path> ProgramFiles::assetRoots() const {
  if (const char* named = std::getenv("CALOT_ASSETS"); named != nullptr && *named != '\0') return {named};
  return {(programs_ / ".." / "share" / "calot").lexically_normal()};
}

std::filesystem::path ProgramFiles::clone() const {
  std::error_code fault;
  const std::filesystem::path assets = std::filesystem::canonical(programs_ / ".." / "share" / "calot", fault);
  if (fault || !std::filesystem::is_regular_file(assets / ".." / "scripts" / "engine.py", fault)) return {};
  return assets.parent_path();
}

}  // namespace calot::recorder
