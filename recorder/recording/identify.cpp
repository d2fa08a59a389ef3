// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "recorder/base/errors.h"
#include "recorder/recording/guarded.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

RecordingIdentity identify(const std::filesystem::path& path) {
  using nlohmann::json;
  const std::string answer = runGuarded(
      path.string(),
      [&path] {
        const Recording recording(path);
        const AttemptHeader& h = recording.header();
        // A participant's name may be any bytes: as numbers it stays what it is.
        return json{{"attempt", h.attempt},
                    {"parent", h.parent},
                    {"participant", std::vector<std::uint8_t>(h.participant.begin(), h.participant.end())},
                    {"steps", recording.stepCount()},
                    {"complete", recording.complete()},
                    {"head", recording.status().back().chain}}
            .dump();
      },
      GuardLimits{std::chrono::seconds(60)});
  const json told = json::parse(answer);
  RecordingIdentity id;
  id.attempt = told["attempt"].get<std::string>();
  id.parent = told["parent"].get<std::string>();
  for (const std::uint8_t c : told["participant"].get<std::vector<std::uint8_t>>())
    id.participant += static_cast<char>(c);
  id.steps = told["steps"].get<std::uint64_t>();
  id.complete = told["complete"].get<bool>();
  const auto head = told["head"].get<std::array<std::uint8_t, 32>>();
  for (std::size_t i = 0; i < head.size(); ++i) id.chainHead[i] = static_cast<std::byte>(head[i]);
  return id;
}

bool looksLikeHdf5(const std::filesystem::path& path) {
  std::array<char, 8> begin{};
  std::ifstream in(path, std::ios::binary);
  in.read(begin.data(), begin.size());
  return in && std::memcmp(begin.data(), "\x89HDF\r\n\x1a\n", begin.size()) == 0;
}

std::vector<std::filesystem::path> filesUnder(const std::vector<std::filesystem::path>& places) {
  namespace fs = std::filesystem;
  std::set<fs::path> files;
  for (const fs::path& place : places) {
    std::error_code error;
    const fs::file_status status = fs::status(place, error);
    if (error || !fs::exists(status)) throw Error(ErrorKind::damaged, Where{place.string()}, "no such file or folder");
    if (!fs::is_directory(status)) {
      files.insert(place);
      continue;
    }
    fs::recursive_directory_iterator at(place, error), end;
    for (; !error && at != end; at.increment(error)) {
      std::error_code gone;  // between listing and looking
      if (fs::is_regular_file(at->symlink_status(gone))) files.insert(at->path());
    }
    if (error)
      throw Error(ErrorKind::damaged, Where{place.string()}, fmt::format("cannot be read: {}", error.message()));
  }
  return {files.begin(), files.end()};
}

}  // namespace calot::recorder
