// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/text_output.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdio.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace fs = std::filesystem;

namespace {

Error alreadyThere(const fs::path& path) {
  return {ErrorKind::invalid, Where{path.string()}, "already exists", {Remedy::replaceExisting}};
}

}  // namespace

void refuseOutput(const fs::path& path, bool force) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    throw Error(ErrorKind::invalid, Where{path.string()}, "is a folder; name a file");
  }
  if (!force && fs::exists(fs::symlink_status(path, ignored))) throw alreadyThere(path);
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, ignored)) {
    throw Error(ErrorKind::invalid, Where{path.string()}, fmt::format("folder {} does not exist", folder.string()));
  }
}

fs::path temporaryName(const fs::path& path) {
  fs::path name = path;
  name += ".part";
  return name;
}

void publish(const fs::path& temporary, const fs::path& path, bool force) {
  int result = ::renameat2(AT_FDCWD, temporary.c_str(), AT_FDCWD, path.c_str(), force ? 0U : RENAME_NOREPLACE);
  if (result != 0 && !force && errno == EINVAL) {  // a file system that cannot promise it
    refuseOutput(path, force);
    result = ::rename(temporary.c_str(), path.c_str());
  }
  if (result == 0) return;
  if (errno == EEXIST) throw alreadyThere(path);
  throw Error(ErrorKind::failure, Where{path.string()},
              fmt::format("cannot be renamed from {}: {}", temporary.filename().string(), std::strerror(errno)));
}

void writeText(const fs::path& path, std::string_view text, bool force) {
  refuseOutput(path, force);
  const fs::path temporary = temporaryName(path);
  std::FILE* file = std::fopen(temporary.c_str(), "wb");
  if (file == nullptr) {
    throw Error(ErrorKind::failure, Where{temporary.string()},
                fmt::format("cannot be created: {}", std::strerror(errno)));
  }
  int fault = 0;
  if (std::fwrite(text.data(), 1, text.size(), file) != text.size()) fault = errno;
  if (fault == 0 && (std::fflush(file) != 0 || ::fsync(::fileno(file)) != 0)) fault = errno;
  if (std::fclose(file) != 0 && fault == 0) fault = errno;
  if (fault == 0 && std::rename(temporary.c_str(), path.c_str()) != 0) fault = errno;
  if (fault == 0) return;
  std::remove(temporary.c_str());
  throw Error(ErrorKind::failure, Where{path.string()}, fmt::format("cannot be written: {}", std::strerror(fault)));
}

}  // namespace calot::recorder
