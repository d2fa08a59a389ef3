// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/external/temporary_folder.h"

#include <stdlib.h>  // mkdtemp

#include <cerrno>
#include <string>
#include <system_error>

#include "recorder/base/errors.h"

namespace calot::analytics {

TemporaryFolder::TemporaryFolder() {
  std::error_code fault;
  const std::filesystem::path place = std::filesystem::temp_directory_path(fault);
  std::string name = ((fault ? std::filesystem::path(".") : place) / "calot-metric-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw Error(ErrorKind::failure, Where{name}, "cannot be made: " + std::generic_category().message(errno));
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace calot::analytics
