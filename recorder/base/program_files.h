// SPDX-License-Identifier: GPL-3.0-or-later
// Where Calot's own files are.
#pragma once

#include <filesystem>
#include <vector>

namespace calot::recorder {

/// The files that come with a program: scenes, organs, performers, forms, protocols, kept engines. They are found from
/// the program's own place, so that an installed tree can be moved: `<programs>/../share/calot`. A build tree has a
/// link there to the assets of the source.
class ProgramFiles {
 public:
  /// @param programs the folder of the programs
  explicit ProgramFiles(std::filesystem::path programs);
  /// Folder of the running program.
  static ProgramFiles ofThisProgram();

  /// Folder of the programs.
  [[nodiscard]] const std::filesystem::path& programs() const { return programs_; }
  /// Folders that may contain `scenes/`, `organs/`, `performers/` and so on, in order of precedence: CALOT_ASSETS of
  /// the environment alone where it is set.
  [[nodiscard]] std::vector<std::filesystem::path> assetRoots() const;
  /// The clone that a program of a build tree was built from; empty where there is none, as for installed programs.
  [[nodiscard]] std::filesystem::path clone() const;

 private:
  std::filesystem::path programs_;
};

}  // namespace calot::recorder
