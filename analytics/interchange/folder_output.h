// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace calot::analytics {

struct WrittenFile {
  std::string name;
  std::uint64_t bytes = 0;
  std::string sha256;  ///< hexadecimal
};

/// A folder of files that appears under its name when it is whole, or not at all: it is filled under `path` + ".part-"
/// and six letters, which goes when this does.
class FolderOutput {
 public:
  /// @throws Error (invalid) where there is something of this name, or no folder to put it in; (failure) where it
  /// cannot be made.
  explicit FolderOutput(const std::filesystem::path& path);
  ~FolderOutput();
  FolderOutput(const FolderOutput&) = delete;
  FolderOutput& operator=(const FolderOutput&) = delete;

  /// @throws Error (failure)
  void add(const std::string& name, std::string_view text);
  /// Where it is filled, for files that add() does not write; files() does not list them.
  [[nodiscard]] const std::filesystem::path& folder() const { return temporary_; }
  [[nodiscard]] const std::vector<WrittenFile>& files() const { return files_; }
  /// Gives the folder its name. @throws Error (failure)
  void finish();

 private:
  std::filesystem::path path_, temporary_;
  std::vector<WrittenFile> files_;
};

}  // namespace calot::analytics
