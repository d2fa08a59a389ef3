// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/publish.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>

#include <cerrno>
#include <cstring>

#include "recorder/errors.h"

namespace calot::recorder {

namespace {

Error alreadyThere(const std::filesystem::path& target) {
  return {ExitCode::usage, fmt::format("{}: already exists; --force replaces it", target.string())};
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
    throw Error(ExitCode::usage, fmt::format("{}: is a folder; name a file", target.string()));
  }
  if (!force && std::filesystem::exists(std::filesystem::symlink_status(target, ignored))) throw alreadyThere(target);
  const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, ignored)) {
    throw Error(ExitCode::usage, fmt::format("{}: folder {} does not exist", target.string(), folder.string()));
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
  throw Error(ExitCode::failure, fmt::format("{}: cannot be renamed from {}: {}", target.string(),
                                             temporary.filename().string(), std::strerror(errno)));
}

}  // namespace calot::recorder
