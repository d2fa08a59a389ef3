// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/attempt/recording_file.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <compare>
#include <mutex>
#include <optional>
#include <set>

#include "analytics/checkpoints/replay_words.h"
#include "recorder/base/errors.h"
#include "recorder/kept/kept_engine.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/recording_facts.h"
#include "sim/scene/version.h"

namespace calot::gui {
namespace {

namespace fs = std::filesystem;

/// Names the content of a file: whoever changes it changes its time of change, which nobody can set.
struct Content {
  std::uint64_t device = 0, number = 0;
  std::int64_t bytes = 0, seconds = 0, nanoseconds = 0;

  auto operator<=>(const Content&) const = default;
};

std::optional<Content> contentOf(const fs::path& file) {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0) return std::nullopt;
  return Content{found.st_dev, found.st_ino, found.st_size, found.st_ctim.tv_sec, found.st_ctim.tv_nsec};
}

/// Files that were read through and are intact, as long as this program runs.
class IntactFiles {
 public:
  void add(const Content& content) {
    const std::lock_guard lock(mutex_);
    known_.insert(content);
  }
  [[nodiscard]] bool hold(const fs::path& file) const {
    const auto content = contentOf(file);
    const std::lock_guard lock(mutex_);
    return content && known_.contains(*content);
  }

 private:
  mutable std::mutex mutex_;
  std::set<Content> known_;
};

IntactFiles& intactFiles() {
  static IntactFiles one;
  return one;
}

void refuse(recorder::Recording& recording, const std::string& attempt) {
  const std::string name = recording.path().filename().string();
  const std::string& found = recording.header().attempt;
  if (!attempt.empty() && found != attempt)
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("is the recording of attempt {}, not of {}", found, attempt));
  if (recording.stepCount() == 0) throw Error(ErrorKind::damaged, Where{name}, "holds no step to show");
  const std::uint32_t version = recording.header().simulationVersion;
  if (version != simulationVersion && recorder::commandOfEngine(version).empty())
    throw Error(ErrorKind::undecided, Where{name},
                fmt::format("was made by simulation version {}; this program has version {}, and no engine of version "
                            "{} is installed to repeat it",
                            version, simulationVersion, version));
}

}  // namespace

fs::path findRecording(const analytics::AttemptRow& attempt, const fs::path& database,
                       const std::vector<fs::path>& folders) {
  // The name comes from a database that anyone may have made: it names a file, never a folder.
  const fs::path name = fs::path(attempt.fileName).filename();
  if (name.empty() || name.extension() != ".h5") return {};
  std::vector<fs::path> places{database.parent_path()};
  places.insert(places.end(), folders.begin(), folders.end());
  fs::path unreadable;
  for (const fs::path& place : places) {
    const fs::path file = place / name;
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) continue;
    try {
      if (recorder::identify(file).attempt == attempt.uuid) return file;
    } catch (const Error&) {
      if (unreadable.empty()) unreadable = file;  // whoever opens it says why
    }
  }
  return unreadable;
}

bool wasReadThrough(const fs::path& file) { return intactFiles().hold(file); }

void readThrough(const fs::path& file) {
  if (wasReadThrough(file)) return;
  const auto before = contentOf(file);
  if (const recorder::ChainVerdict chain = recorder::probe(file); !chain.intact())
    throw Error(ErrorKind::refused, Where{file.filename().string()},
                fmt::format("its content chain is broken ({})", analytics::wordsFor(chain)));
  if (before && before == contentOf(file)) intactFiles().add(*before);
}

recorder::Recording openBeginning(const fs::path& file, const std::string& attempt) {
  if (!wasReadThrough(file)) recorder::probeBeginning(file);
  recorder::Recording recording(file);
  refuse(recording, attempt);
  return recording;
}

recorder::Recording openRecording(const fs::path& file, const std::string& attempt) {
  readThrough(file);
  return openBeginning(file, attempt);
}

}  // namespace calot::gui
