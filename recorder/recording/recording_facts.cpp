// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/recording_facts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "recorder/base/errors.h"
#include "recorder/recording/file_reader.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

std::string readIdentity(const std::string& file) {
  const Recording recording(file);
  const AttemptHeader& h = recording.header();
  const auto head = std::as_bytes(std::span(recording.status().back().chain));
  RecordingIdentity id{h.attempt, h.parent, h.participant, recording.stepCount(), recording.complete(), {}};
  std::copy(head.begin(), head.end(), id.chainHead.begin());
  return packed(id);
}

RecordingIdentity identify(const std::filesystem::path& path) {
  RecordingIdentity id;
  if (!unpack(runProbe(readIdentity, path, GuardLimits{std::chrono::seconds(60)}), id))
    throw Error(ErrorKind::damaged, Where{path.string()}, "the reading library failed on it; the file is damaged");
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

namespace {

using Groups = std::map<std::string, std::uint64_t>;

/// Called for every object, each once whatever links to it.
herr_t addDataset(hid_t file, const char* name, const H5O_info_t* info, void* groups) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  const hdf5::Id dataset = hdf5::dataset(H5Dopen2(file, name, H5P_DEFAULT));
  if (!dataset.valid()) return -1;
  const std::string_view path = name;
  (*static_cast<Groups*>(groups))[std::string(path.substr(0, path.find('/')))] += H5Dget_storage_size(dataset.get());
  return 0;
}

}  // namespace

std::vector<StoredBytes> storedBytes(const std::filesystem::path& path) {
  Groups groups;
  {
    const hdf5::Session session;
    const hdf5::Id file = openForReading(path, Access::settled);
    if (H5Ovisit2(file.get(), H5_INDEX_NAME, H5_ITER_INC, addDataset, &groups, H5O_INFO_BASIC) < 0)
      throw hdf5::damaged(path, "/", hdf5::reason());
  }
  std::uint64_t sum = 0;
  for (const auto& [group, bytes] : groups) sum += bytes;
  const std::uint64_t whole = sizeOfFile(path);
  groups["structure"] += whole > sum ? whole - sum : 0;
  std::vector<StoredBytes> out;
  for (const auto& [group, bytes] : groups) out.push_back({group, bytes});
  std::stable_sort(out.begin(), out.end(),
                   [](const StoredBytes& a, const StoredBytes& b) { return a.bytes > b.bytes; });
  return out;
}

RawStatistics rawStatistics(Recording& recording, Hand hand) {
  constexpr std::uint64_t most = 4096;
  RawStatistics s;
  s.samples = recording.rawSampleCount(hand);
  s.dropped = recording.rawSamplesDropped(hand);
  std::optional<std::uint64_t> sequence;
  std::optional<double> first, last;  // s; doubles, since untrusted numbers may have any value
  for (std::uint64_t at = 0; at < s.samples; at += most) {
    for (const RawSample& raw : recording.rawSamples(hand, at, std::min(most, s.samples - at))) {
      if (sequence && raw.sample.sequence > *sequence) s.missing += raw.sample.sequence - *sequence - 1;
      sequence = raw.sample.sequence;
      if (raw.used) ++s.used;
      if (!raw.sample.valid) continue;
      ++s.valid;
      const double time = 1e-9 * static_cast<double>(raw.sample.hostTime);
      if (!first) first = time;
      if (last) s.maxInterval = std::max(s.maxInterval, time - *last);
      last = time;
    }
  }
  if (s.valid > 1 && *last > *first) s.rate = static_cast<double>(s.valid - 1) / (*last - *first);
  return s;
}

}  // namespace calot::recorder
