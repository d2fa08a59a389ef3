// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/places.h"

#include <dlfcn.h>

#include <system_error>

#include "recorder/base/files.h"

namespace calot::python {

std::filesystem::path programFolder() {
  static const char here = 0;
  Dl_info info{};
  if (dladdr(&here, &info) == 0 || info.dli_fname == nullptr) return {};
  std::error_code ignored;
  const std::filesystem::path module = std::filesystem::absolute(info.dli_fname, ignored);
  for (std::filesystem::path at = module.parent_path(); at.has_relative_path(); at = at.parent_path()) {
    const bool built = std::filesystem::exists(at / "bin/calot-engine", ignored);
    if (built || std::filesystem::is_directory(at / "share/calot", ignored)) return at / "bin";
  }
  return {};
}

std::vector<std::filesystem::path> assetFolders() { return recorder::ProgramFiles(programFolder()).assetRoots(); }

}  // namespace calot::python
