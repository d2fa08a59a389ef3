// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/intake/intake.h"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <system_error>
#include <tuple>
#include <utility>

#include "analytics/checkpoints/motion.h"
#include "analytics/checkpoints/replay_words.h"
#include "analytics/cohort/cohort_database.h"
#include "recorder/recording/recording_facts.h"
#include "sim/scene/version.h"

namespace calot::analytics {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::system_clock;

constexpr std::int64_t firstRetry = 10, lastRetry = 3600;  // s

/// Ends a re-simulation from its progress.
struct IntakeStopped {};

std::int64_t secondsNow() {
  return std::chrono::duration_cast<seconds>(system_clock::now().time_since_epoch()).count();
}

std::int64_t backOff(std::uint32_t tries) {
  return std::min(lastRetry, firstRetry << std::min<std::uint32_t>(tries - 1, 16));
}

/// Names that a file has while it is written or copied.
bool isTemporary(const std::filesystem::path& file) {
  const std::string name = file.filename().string(), extension = file.extension().string();
  return name.front() == '.' || extension == ".part" || extension == ".branch";
}

/// For how long it has not changed, by its own clock; nothing where that clock is ahead of ours.
milliseconds ageOf(const FileState& state) {
  const auto now = std::chrono::duration_cast<std::chrono::nanoseconds>(system_clock::now().time_since_epoch());
  return std::max(std::chrono::duration_cast<milliseconds>(now - std::chrono::nanoseconds(state.modified)),
                  milliseconds(0));
}

/// An unusable cohort or folder is reported at once, and leaves no journal.
IntakeSettings checked(IntakeSettings settings) {
  std::error_code ignored;
  if (std::filesystem::exists(settings.cohort, ignored)) {
    const CohortDatabase opened(settings.cohort, CohortDatabase::Access::read);
  }
  static_cast<void>(recorder::filesUnder(settings.folders));
  return settings;
}

}  // namespace

Intake::Intake(IntakeSettings settings) : settings_(checked(std::move(settings))), journal_(settings_.journal) {}

bool Intake::isDecided(const std::string& file, const FileState& state, IntakeRest& rest) const {
  const JournalEntry* entry = journal_.find(file);
  if (entry == nullptr || entry->state != state) return false;
  if (entry->tries > 0) {
    const bool later = entry->retryAt > secondsNow();
    rest.retries += later ? 1U : 0U;
    return later;
  }
  // This version may decide recordings that another version could not.
  return !entry->otherVersion || entry->simulationVersion == simulationVersion;
}

std::vector<Intake::Candidate> Intake::candidates(IntakeRest& rest) {
  std::vector<Candidate> list;
  std::map<std::string, Seen> seen;
  const auto now = std::chrono::steady_clock::now();
  for (const std::filesystem::path& path : recorder::filesUnder(settings_.folders)) {
    const std::string file = path.string();
    const FileState state = fileState(path);
    if (isTemporary(path) || state == FileState{} || isDecided(file, state, rest)) continue;
    if (!recorder::looksLikeHdf5(path)) continue;  // last: it opens the file
    const auto known = seen_.find(file);
    const Seen& entry =
        seen.emplace(file, known != seen_.end() && known->second.state == state ? known->second : Seen{state, now})
            .first->second;
    const milliseconds unchanged = std::max(ageOf(state), std::chrono::duration_cast<milliseconds>(now - entry.since));
    if (unchanged < settings_.quiet) {
      ++rest.settling;
      continue;
    }
    const JournalEntry* before = journal_.find(file);
    const std::uint32_t tries = before != nullptr && before->state == state ? before->tries : 0;
    list.push_back({file, state, unchanged, tries});
  }
  seen_ = std::move(seen);
  std::sort(list.begin(), list.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.state.modified, a.file) < std::tie(b.state.modified, b.file);
  });
  return list;
}

IntakeRest Intake::look(const std::function<void(const IntakeItem&)>& tell, const std::atomic<bool>& stop) {
  IntakeRest rest;
  for (const Candidate& candidate : candidates(rest)) {
    if (stop) break;
    std::optional<IntakeItem> item;
    try {
      item = take(candidate, rest, stop);
    } catch (const Error& e) {
      const TakenIn how = e.kind() == ErrorKind::refused ? TakenIn::refused : TakenIn::failed;
      item = {.file = candidate.file, .how = how, .fault = e};
    } catch (const std::exception& e) {
      item = {.file = candidate.file,
              .how = TakenIn::failed,
              .fault = Error(ErrorKind::failure, Where{candidate.file}, e.what())};
    }
    if (!item) continue;
    if (item->how == TakenIn::failed) item->retryIn = backOff(candidate.tries + 1);
    tell(*item);
    enter(*item, candidate);
  }
  return rest;
}

std::optional<IntakeItem> Intake::take(const Candidate& c, IntakeRest& rest, const std::atomic<bool>& stop) const {
  recorder::RecordingIdentity identity;
  try {
    identity = recorder::identify(c.file);
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::damaged) throw;
    if (c.unchanged >= settings_.settle) return IntakeItem{.file = c.file, .how = TakenIn::damaged, .fault = e};
  }
  if ((identity.attempt.empty() || !identity.complete) && c.unchanged < settings_.settle) {
    ++rest.growing;
    return std::nullopt;
  }
  std::error_code ignored;
  if (std::filesystem::exists(settings_.cohort, ignored) &&
      isVerified(CohortDatabase(settings_.cohort, CohortDatabase::Access::read), identity))
    return IntakeItem{.file = c.file, .how = TakenIn::known, .attempt = identity.attempt};
  JudgedRecording judged;
  try {
    AssessSettings assess{.threads = settings_.threads};
    assess.engine.apart = settings_.apart;
    assess.progress = [&](auto, auto) {
      if (stop) throw IntakeStopped();
    };
    judged = assessRecording(c.file, assess);
  } catch (const IntakeStopped&) {
    return std::nullopt;
  }
  if (fileState(c.file) != c.state) {  // it went on while it was verified
    ++rest.growing;
    return std::nullopt;
  }
  IntakeItem item{.file = c.file, .judged = std::move(judged), .attempt = identity.attempt};
  if (!item.judged.record) {
    item.how = TakenIn::damaged;
    item.fault = Error(ErrorKind::damaged, Where{c.file}, wordsFor(item.judged.report), item.judged.report.remedies);
    return item;
  }
  const Imported imported = CohortDatabase(settings_.cohort, CohortDatabase::Access::create)
                                .storeAttempt(*item.judged.record, item.judged.values);
  item.how = imported == Imported::added      ? TakenIn::added
             : imported == Imported::extended ? TakenIn::extended
                                              : TakenIn::unchanged;
  return item;
}

void Intake::enter(const IntakeItem& item, const Candidate& c) {
  JournalEntry entry;
  entry.state = c.state;
  entry.simulationVersion = simulationVersion;
  entry.otherVersion =
      item.judged.record.has_value() && item.judged.report.verdict == recorder::ReplayVerdict::undecided;
  if (item.how == TakenIn::failed) {
    entry.tries = c.tries + 1;
    entry.retryAt = secondsNow() + item.retryIn;
  }
  journal_.put(c.file, entry);
  seen_.erase(c.file);
}

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
