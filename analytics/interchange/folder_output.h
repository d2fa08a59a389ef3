// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
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
  /// @param force whether to replace a folder of this name, unless it holds a file that the new one has not (finish()
  /// looks); none: never
  /// @throws Error (invalid) where there is something of this name that is not to be replaced, or no folder to put it
  /// in; (failure) where it cannot be made.
  explicit FolderOutput(const std::filesystem::path& path, std::optional<bool> force = {});
  ~FolderOutput();
  FolderOutput(const FolderOutput&) = delete;
  FolderOutput& operator=(const FolderOutput&) = delete;

  /// @throws Error (failure)
  void add(const std::string& name, std::string_view text);
  /// The folder being filled, for files that add() does not write; files() does not list them.
  [[nodiscard]] const std::filesystem::path& folder() const { return temporary_; }
  [[nodiscard]] const std::vector<WrittenFile>& files() const { return files_; }
  /// Gives the folder its name. @throws Error (failure); (invalid) where a folder of this name is not to be replaced
  void finish();

 private:
  void replace();

  std::filesystem::path path_, temporary_;
  bool force_;
  std::vector<WrittenFile> files_;
};

}  // namespace calot::analytics
