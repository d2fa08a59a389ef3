// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/compliance_cache.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "sim/math/fields.h"
#include "sim/scene/version.h"

namespace calot::recorder {

const float* SharedCompliances::find(std::size_t solid, std::size_t node) {
  const std::lock_guard lock(mutex_);
  const Place place{solid, node};
  if (const auto at = held_.find(place); at != held_.end()) return at->second->data();
  const auto offered = offered_.find(place);
  if (offered == offered_.end() || !proven_[solid]) return nullptr;
  auto& held = held_[place];
  held = std::make_unique<const std::vector<float>>(std::move(offered->second));
  offered_.erase(offered);
  return held->data();
}

const float* SharedCompliances::keep(std::size_t solid, std::size_t node, std::vector<float> column) {
  const std::lock_guard lock(mutex_);
  const Place place{solid, node};
  if (const auto at = held_.find(place); at != held_.end()) return at->second->data();  // of another thread
  if (const auto offered = offered_.find(place); offered != offered_.end()) {
    // Bit for bit: 0 and -0 differ.
    proven_[solid] = std::ranges::equal(std::as_bytes(std::span(offered->second)), std::as_bytes(std::span(column)));
    refuted_ = refuted_ || !proven_[solid];
    if (refuted_) {
      offered_.clear();
    } else {
      offered_.erase(offered);
    }
  }
  ++computed_;
  auto& held = held_[place];
  held = std::make_unique<const std::vector<float>>(std::move(column));
  return held->data();
}

void SharedCompliances::offer(std::vector<ComplianceColumn> columns) {
  const std::lock_guard lock(mutex_);
  for (ComplianceColumn& c : columns) offered_[{c.solid, c.node}] = std::move(c.value);
}

std::vector<ComplianceColumn> SharedCompliances::columns() const {
  const std::lock_guard lock(mutex_);
  std::vector<ComplianceColumn> all;
  const auto add = [&](const Place& place, const std::vector<float>& value) {
    all.push_back({static_cast<std::uint32_t>(place.first), static_cast<std::uint32_t>(place.second), value});
  };
  for (const auto& [place, value] : held_) add(place, *value);
  for (const auto& [place, value] : offered_) add(place, value);
  return all;
}

std::size_t SharedCompliances::computed() const {
  const std::lock_guard lock(mutex_);
  return computed_;
}

bool SharedCompliances::refuted() const {
  const std::lock_guard lock(mutex_);
  return refuted_;
}

namespace fs = std::filesystem;

namespace {

static_assert(std::endian::native == std::endian::little);

constexpr const char* extension = ".compliances";
constexpr const char* cacheFormat = "calot-compliances-1";
constexpr std::size_t maxHeader = 4096;                          ///< of the first line (bytes)
constexpr std::size_t maxEntry = std::size_t{512} << 20U;        ///< of a file (bytes); above: nothing that was written
constexpr std::uint32_t maxColumn = std::uint32_t{9} * 1000000;  ///< numbers of a column

/// Its owner is this user, and no other may write it.
bool isOwn(const fs::path& file) {
  struct stat status {};
  return lstat(file.c_str(), &status) == 0 && S_ISREG(status.st_mode) && status.st_uid == geteuid() &&
         (status.st_mode & (S_IWGRP | S_IWOTH)) == 0;
}

std::string payloadOf(const std::vector<ComplianceColumn>& columns) {
  std::string payload;
  for (const ComplianceColumn& c : columns) {
    const std::array<std::uint32_t, 3> head{c.solid, c.node, static_cast<std::uint32_t>(c.value.size())};
    payload.append(reinterpret_cast<const char*>(head.data()), sizeof head);
    payload.append(reinterpret_cast<const char*>(c.value.data()), c.value.size() * sizeof(float));
  }
  return payload;
}

std::string digestOf(std::string_view payload) {
  return fmt::format("{:016x}", digest64(std::as_bytes(std::span(payload))));
}

struct Entry {
  std::string key, payload;
  CacheEntry facts;
};

/// Contents of a file, if its payload is the one that was written.
std::optional<Entry> readEntry(const fs::path& file) {
  try {
    const std::vector<std::byte> bytes = readFileBytes(file, file.filename().string(), maxEntry);
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    const std::size_t end = text.substr(0, maxHeader).find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    const nlohmann::json header = nlohmann::json::parse(text.substr(0, end));
    Entry entry{header.at("key"), std::string(text.substr(end + 1)), {}};
    entry.facts.scene = header.at("scene");
    entry.facts.simulationVersion = header.at("simulation_version");
    entry.facts.columns = header.at("columns");
    const bool whole = header.at("format") == cacheFormat && header.at("digest") == digestOf(entry.payload);
    return whole ? std::optional(std::move(entry)) : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

/// @returns false where the payload does not end with a column.
bool readColumns(std::string_view payload, std::vector<ComplianceColumn>& columns) {
  while (!payload.empty()) {
    std::array<std::uint32_t, 3> head{};
    if (payload.size() < sizeof head) return false;
    std::memcpy(head.data(), payload.data(), sizeof head);
    payload.remove_prefix(sizeof head);
    if (head[2] > maxColumn || payload.size() < head[2] * sizeof(float)) return false;
    ComplianceColumn& column = columns.emplace_back(ComplianceColumn{head[0], head[1], std::vector<float>(head[2])});
    std::memcpy(column.value.data(), payload.data(), head[2] * sizeof(float));
    payload.remove_prefix(head[2] * sizeof(float));
  }
  return true;
}

CacheEntry look(const fs::path& file) {
  CacheEntry entry;
  if (file.extension() != extension) {
    entry.state = CacheEntry::State::leftover;
  } else if (!isOwn(file)) {
    entry.state = CacheEntry::State::foreign;
  } else if (std::optional<Entry> found = readEntry(file)) {
    entry = std::move(found->facts);
    entry.state =
        entry.simulationVersion == simulationVersion ? CacheEntry::State::usable : CacheEntry::State::otherVersion;
  }
  entry.file = file;
  std::error_code ignored;
  entry.bytes = fs::file_size(file, ignored);
  return entry;
}

/// The files in the folder that this class makes, by name.
std::vector<fs::path> entriesOf(const fs::path& folder, std::error_code& fault) {
  std::vector<fs::path> files;
  for (fs::directory_iterator it(folder, fault), end; !fault && it != end; it.increment(fault)) {
    const std::string name = it->path().filename().string();
    std::error_code gone;
    if (name.find(extension) != std::string::npos && !it->is_directory(gone)) files.push_back(it->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace

std::string complianceKey(const std::vector<Asset>& assets) {
  std::string text = fmt::format("{}\nsimulation version {}\n", cacheFormat, simulationVersion);
  for (const Asset& asset : assets) text += fmt::format("{} {}\n", sha256Hex(asset.bytes), asset.name);
  return sha256Hex(std::as_bytes(std::span(text)));
}

std::optional<fs::path> userCacheFolder() {
  const char* named = std::getenv("CALOT_CACHE");
  const std::string own = named == nullptr ? "" : named;
  if (!own.empty()) return own == "off" ? std::nullopt : std::optional<fs::path>(own);
  const fs::path folder = userFolder("XDG_CACHE_HOME", ".cache");
  return folder.empty() ? std::nullopt : std::optional(folder / "calot");
}

fs::path ComplianceCache::fileOf(const std::string& key) const { return folder_ / (key + extension); }

std::vector<ComplianceColumn> ComplianceCache::load(const std::string& key) const {
  const fs::path file = fileOf(key);
  if (!isOwn(file)) return {};
  const std::optional<Entry> entry = readEntry(file);
  std::vector<ComplianceColumn> columns;
  if (!entry || entry->key != key || !readColumns(entry->payload, columns)) return {};
  return columns;
}

bool ComplianceCache::save(const std::string& key, const std::string& scene,
                           const std::vector<ComplianceColumn>& columns) const {
  std::error_code fault;
  fs::create_directories(folder_.parent_path(), fault);
  if (fault || (mkdir(folder_.c_str(), S_IRWXU) != 0 && !fs::is_directory(folder_, fault))) return false;
  const std::string payload = payloadOf(columns);
  const nlohmann::json header = {{"format", cacheFormat},
                                 {"key", key},
                                 {"scene", scene},
                                 {"simulation_version", simulationVersion},
                                 {"columns", columns.size()},
                                 {"digest", digestOf(payload)}};
  const std::string line = header.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) + '\n';
  if (line.size() > maxHeader || line.size() + payload.size() > maxEntry) return false;
  try {
    writeSecret(fileOf(key), line + payload, true);
  } catch (const Error&) {
    return false;
  }
  makeRoom(fileOf(key));
  return true;
}

/// Removes the oldest entries until all together fit.
void ComplianceCache::makeRoom(const fs::path& newest) const {
  std::error_code fault;
  struct File {
    fs::file_time_type written;
    fs::path path;
    std::uint64_t bytes;
  };
  std::vector<File> files;
  std::uint64_t all = 0;
  for (const fs::path& path : entriesOf(folder_, fault)) {
    std::error_code gone;
    const File file{fs::last_write_time(path, gone), path, fs::file_size(path, gone)};
    if (gone) continue;
    files.push_back(file);
    all += file.bytes;
  }
  std::sort(files.begin(), files.end(), [](const File& a, const File& b) { return a.written < b.written; });
  for (const File& file : files) {
    if (all <= maxBytes) break;
    if (file.path == newest) continue;
    fs::remove(file.path, fault);
    all -= file.bytes;
  }
}

std::vector<CacheEntry> ComplianceCache::list() const {
  std::error_code fault;
  if (!fs::exists(folder_, fault)) return {};
  std::vector<CacheEntry> entries;
  for (const fs::path& file : entriesOf(folder_, fault)) entries.push_back(look(file));
  if (fault) throw Error(ErrorKind::failure, Where{folder_.string()}, "cannot be read: " + fault.message());
  return entries;
}

std::vector<CacheEntry> ComplianceCache::clean(bool usableToo) const {
  std::vector<CacheEntry> removed;
  for (const CacheEntry& entry : list()) {
    if (entry.state == CacheEntry::State::usable && !usableToo) continue;
    std::error_code fault;
    fs::remove(entry.file, fault);
    if (fault) throw Error(ErrorKind::failure, Where{entry.file.string()}, "cannot be removed: " + fault.message());
    removed.push_back(entry);
  }
  return removed;
}

}  // namespace calot::recorder
