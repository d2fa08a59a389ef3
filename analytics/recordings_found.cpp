// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/recordings_found.h"

#include <algorithm>
#include <exception>
#include <iterator>
#include <utility>

namespace calot::analytics {

RecordingsFound::RecordingsFound(const std::vector<std::filesystem::path>& places, recorder::WorkerPool& pool) {
  const std::vector<std::filesystem::path> files = recorder::filesUnder(places);
  std::vector<std::optional<recorder::RecordingIdentity>> identity(files.size());
  std::vector<std::optional<Error>> fault(files.size());
  const auto look = [&](std::size_t i) {
    const bool named = std::find(places.begin(), places.end(), files[i]) != places.end();
    if (!named && !recorder::looksLikeHdf5(files[i])) return;
    try {
      identity[i] = recorder::identify(files[i]);
    } catch (const Error& e) {
      fault[i] = e;
    } catch (const std::exception& e) {
      fault[i] = Error(ErrorKind::failure, Where{files[i].string()}, e.what());
    }
  };
  pool.run(files.size(), look);
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (identity[i]) byUuid_[identity[i]->attempt].push_back({files[i], *identity[i]});
    if (fault[i]) notRead_.push_back(*fault[i]);
  }
}

std::optional<std::filesystem::path> RecordingsFound::of(const AttemptRow& a) const {
  const auto at = byUuid_.find(a.uuid);
  if (at == byUuid_.end()) return std::nullopt;
  const auto better = [&](const Entry& x, const Entry& y) {
    const bool mine = x.identity.chainHead == a.chainHead, yours = y.identity.chainHead == a.chainHead;
    if (mine != yours) return mine;
    const bool mineNamed = x.file.filename() == a.fileName, yoursNamed = y.file.filename() == a.fileName;
    if (mine && mineNamed != yoursNamed) return mineNamed;
    if (x.identity.steps != y.identity.steps) return x.identity.steps > y.identity.steps;
    return x.file < y.file;
  };
  return std::min_element(at->second.begin(), at->second.end(), better)->file;
}

std::vector<std::filesystem::path> recordingsUnder(const std::vector<std::filesystem::path>& places) {
  std::vector<std::filesystem::path> files = recorder::filesUnder(places);
  std::erase_if(files, [&](const std::filesystem::path& file) {
    const bool named = std::find(places.begin(), places.end(), file) != places.end();
    return !named && !recorder::looksLikeHdf5(file);
  });
  if (files.empty())
    throw Error(ErrorKind::damaged, Where{places.empty() ? "" : places.front().string()},
                "there are no recordings in it");
  return files;
}

}  // namespace calot::analytics
