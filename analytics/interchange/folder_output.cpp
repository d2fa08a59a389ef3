// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/folder_output.h"

#include <fmt/format.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): mkdtemp is POSIX

#include <cerrno>
#include <cstring>
#include <span>
#include <system_error>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::analytics {
namespace fs = std::filesystem;

FolderOutput::FolderOutput(const fs::path& path, std::optional<bool> force)
    : path_(path), force_(force.value_or(false)) {
  if (path_.filename().empty()) path_ = path_.parent_path();  // "out/"
  std::error_code ignored;
  const fs::file_status there = fs::symlink_status(path_, ignored);
  if (path_.empty() || (fs::exists(there) && !(force_ && fs::is_directory(there)))) {
    if (!path_.empty() && force && fs::is_directory(there))
      throw Error(ErrorKind::invalid, Where{path.string()}, "already exists", {Remedy::replaceExisting});
    throw Error(ErrorKind::invalid, Where{path.string()}, "already exists; name a folder that does not");
  }
  const fs::path above = path_.has_parent_path() ? path_.parent_path() : fs::path(".");
  if (!fs::is_directory(above, ignored))
    throw Error(ErrorKind::invalid, Where{path.string()}, fmt::format("folder {} does not exist", above.string()));
  std::string pattern = path_.string() + ".part-XXXXXX";
  if (::mkdtemp(pattern.data()) == nullptr)
    throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("cannot be made: {}", std::strerror(errno)));
  temporary_ = pattern;
}

FolderOutput::~FolderOutput() {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void FolderOutput::add(const std::string& name, std::string_view text) {
  recorder::writeText(temporary_ / name, text, false);
  files_.push_back({name, text.size(), recorder::sha256Hex(std::as_bytes(std::span(text)))});
}

void FolderOutput::replace() {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path_)) {
    const fs::path name = entry.path().lexically_relative(path_);
    if (fs::exists(fs::symlink_status(temporary_ / name))) continue;
    throw Error(ErrorKind::invalid, Where{entry.path().string()},
                "would be lost: it is not among what is written; name another folder");
  }
  const fs::path before = temporary_.string() + ".before";
  fs::rename(path_, before);
  std::error_code error;
  fs::rename(temporary_, path_, error);
  if (error) {
    fs::rename(before, path_);
    throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("cannot be named: {}", error.message()));
  }
  fs::remove_all(before, error);
  temporary_.clear();
}

void FolderOutput::finish() {
  std::error_code error;
  if (force_ && fs::is_directory(fs::symlink_status(path_, error))) {
    try {
      replace();
    } catch (const fs::filesystem_error& e) {
      throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("cannot be replaced: {}", e.what()));
    }
    return;
  }
  fs::rename(temporary_, path_, error);
  if (error)
    throw Error(ErrorKind::failure, Where{path_.string()}, fmt::format("cannot be named: {}", error.message()));
  temporary_.clear();
}

}  // namespace calot::analytics
