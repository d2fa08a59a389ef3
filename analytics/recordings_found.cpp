// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/recordings_found.h"

#include <algorithm>
#include <exception>
#include <numeric>

namespace calot::analytics {
namespace {

std::vector<std::size_t> allOf(std::size_t count) {
  std::vector<std::size_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  return numbers;
}

}  // namespace

RecordingsFound::RecordingsFound(const std::vector<std::filesystem::path>& places, recorder::WorkerPool& pool)
    : files_(recorder::filesUnder(places)), looked_(files_.size(), 0) {
  lookInto(allOf(files_.size()), places, pool);
}

RecordingsFound::RecordingsFound(const std::vector<std::filesystem::path>& places,
                                 const std::vector<const AttemptRow*>& wanted, recorder::WorkerPool& pool)
    : files_(recorder::filesUnder(places)), looked_(files_.size(), 0) {
  std::map<std::string, std::vector<std::size_t>> byName;
  for (std::size_t i = 0; i < files_.size(); ++i) byName[files_[i].filename().string()].push_back(i);
  std::vector<std::size_t> likely;
  for (const AttemptRow* attempt : wanted) {
    const auto named = byName.find(attempt->fileName);
    if (named != byName.end()) likely.insert(likely.end(), named->second.begin(), named->second.end());
  }
  std::sort(likely.begin(), likely.end());
  likely.erase(std::unique(likely.begin(), likely.end()), likely.end());
  lookInto(likely, places, pool);
  const auto isFound = [&](const AttemptRow* attempt) {
    const auto at = byUuid_.find(attempt->uuid);
    return at != byUuid_.end() && std::any_of(at->second.begin(), at->second.end(), [&](const Entry& e) {
             return e.identity.chainHead == attempt->chainHead;
           });
  };
  // Motion without a scene has no recording.
  const auto isLost = [&](const AttemptRow* attempt) { return attempt->simulationVersion != 0 && !isFound(attempt); };
  if (std::any_of(wanted.begin(), wanted.end(), isLost)) lookInto(allOf(files_.size()), places, pool);
}

void RecordingsFound::lookInto(const std::vector<std::size_t>& files, const std::vector<std::filesystem::path>& places,
                               recorder::WorkerPool& pool) {
  std::vector<std::size_t> fresh;
  std::copy_if(files.begin(), files.end(), std::back_inserter(fresh), [&](std::size_t i) { return looked_[i] == 0; });
  std::vector<std::optional<recorder::RecordingIdentity>> identity(fresh.size());
  std::vector<std::optional<Error>> fault(fresh.size());
  const auto look = [&](std::size_t i) {
    const std::filesystem::path& file = files_[fresh[i]];
    const bool named = std::find(places.begin(), places.end(), file) != places.end();
    if (!named && !recorder::looksLikeHdf5(file)) return;
    try {
      identity[i] = recorder::identify(file);
    } catch (const Error& e) {
      fault[i] = e;
    } catch (const std::exception& e) {
      fault[i] = Error(ErrorKind::failure, Where{file.string()}, e.what());
    }
  };
  pool.run(fresh.size(), look);
  for (std::size_t i = 0; i < fresh.size(); ++i) {
    looked_[fresh[i]] = 1;
    if (identity[i]) byUuid_[identity[i]->attempt].push_back({files_[fresh[i]], *identity[i]});
    if (fault[i]) notRead_.push_back(*fault[i]);
  }
}

std::optional<std::filesystem::path> RecordingsFound::of(const AttemptRow& a) const {
  const auto at = byUuid_.find(a.uuid);
  if (at == byUuid_.end()) return std::nullopt;
  const auto better = [&](const Entry& x, const Entry& y) {
    const bool mine = x.identity.chainHead == a.chainHead, yours = y.identity.chainHead == a.chainHead;
    if (mine != yours) return mine;
    if (x.identity.steps != y.identity.steps) return x.identity.steps > y.identity.steps;
    return x.file < y.file;
  };
  return std::min_element(at->second.begin(), at->second.end(), better)->file;
}

}  // namespace calot::analytics
