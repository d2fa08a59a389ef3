// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <filesystem>
#include <vector>

namespace calot::analytics {

/// Notices that files come into folders and below, or are finished there (inotify). What other machines do to a network
/// file system goes unnoticed, as does anything beyond the system's limit of watches: whoever waits also looks by
/// himself from time to time.
class FolderWatch {
 public:
  explicit FolderWatch(std::vector<std::filesystem::path> folders);
  ~FolderWatch();
  FolderWatch(const FolderWatch&) = delete;
  FolderWatch& operator=(const FolderWatch&) = delete;

  /// Waits until something has changed, the time is over, or a signal came. @returns whether something has changed
  bool wait(std::chrono::milliseconds longest);

 private:
  void watchAll();

  std::vector<std::filesystem::path> folders_;
  int notifier_ = -1;  ///< none: only time passes
};

}  // namespace calot::analytics
