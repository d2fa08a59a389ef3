// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/intake/folder_watch.h"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <system_error>
#include <utility>

namespace calot::analytics {
namespace fs = std::filesystem;

FolderWatch::FolderWatch(std::vector<fs::path> folders)
    : folders_(std::move(folders)), notifier_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  watchAll();
}

FolderWatch::~FolderWatch() {
  if (notifier_ >= 0) ::close(notifier_);
}

void FolderWatch::watchAll() {
  if (notifier_ < 0) return;
  // A folder that is watched already stays as it is. Writing is not watched: a recording that grows would never rest.
  constexpr std::uint32_t events = IN_CREATE | IN_CLOSE_WRITE | IN_MOVED_TO | IN_ONLYDIR;
  for (const fs::path& folder : folders_) {
    ::inotify_add_watch(notifier_, folder.c_str(), events);
    std::error_code error;
    for (fs::recursive_directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
      std::error_code gone;
      if (fs::is_directory(at->symlink_status(gone))) ::inotify_add_watch(notifier_, at->path().c_str(), events);
    }
  }
}

bool FolderWatch::wait(std::chrono::milliseconds longest) {
  pollfd p{notifier_, POLLIN, 0};  // poll() passes over a negative one
  if (::poll(&p, 1, static_cast<int>(longest.count())) <= 0) return false;
  alignas(inotify_event) std::array<char, 16384> buffer;
  while (::read(notifier_, buffer.data(), buffer.size()) > 0) {
  }
  watchAll();  // a folder may be new
  return true;
}

}  // namespace calot::analytics
