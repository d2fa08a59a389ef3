// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/publish.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>

#include <cerrno>
#include <cstring>

#include "recorder/base/errors.h"

namespace calot::recorder {

namespace {

Error alreadyThere(const std::filesystem::path& target) {
  return {ErrorKind::invalid, Where{target.string()}, "already exists", {Remedy::replaceExisting}};
}

}  // namespace

std::filesystem::path temporaryName(const std::filesystem::path& target) {
  std::filesystem::path name = target;
  name += ".part";
  return name;
}

void refuseExisting(const std::filesystem::path& target, bool force) {
  std::error_code ignored;
  if (std::filesystem::is_directory(target, ignored)) {
    throw Error(ErrorKind::invalid, Where{target.string()}, "is a folder; name a file");
  }
  if (!force && std::filesystem::exists(std::filesystem::symlink_status(target, ignored))) throw alreadyThere(target);
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw Error(ErrorKind::invalid, Where{target.string()}, fmt::format("folder {} does not exist", folder.string()));
  }
}

void publish(const std::filesystem::path& temporary, const std::filesystem::path& target, bool force) {
  int result = ::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, target.c_str(), force ? 0U : RENAME_NOREPLACE);
  if (result != 0 && !force && errno == EINVAL) {  // a file system that cannot promise it
    refuseExisting(target, force);
    result = ::rename(temporary.c_str(), target.c_str());
  }
  if (result == 0) return;
  if (errno == EEXIST) throw alreadyThere(target);
  throw Error(ErrorKind::failure, Where{target.string()},
              fmt::format("cannot be renamed from {}: {}", temporary.filename().string(), std::strerror(errno)));
}

}  // namespace calot::recorder
