// SPDX-License-Identifier: GPL-3.0-or-later
// Rest compliances in the user's cache folder, so that the next program need not work them out again. A convenience:
// whatever is missing, damaged, of another version or of another user is left alone and computed again.
// All sessions of a scene share the columns, on any thread; a file's are believed once one was computed alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "recorder/base/identity.h"
#include "sim/solid/solid.h"

namespace calot::recorder {

/// A column with its place: number of the solid, of the node.
struct ComplianceColumn {
  std::uint32_t solid = 0, node = 0;
  std::vector<float> value;
};

class SharedCompliances final : public ComplianceStore {
 public:
  [[nodiscard]] const float* find(std::size_t solid, std::size_t node) override;
  const float* keep(std::size_t solid, std::size_t node, std::vector<float> column) override;

  /// Columns that are said to be this scene's. A solid's are given out once one of them was worked out here and came
  /// out the same; where one differs, none of any solid is. @pre before the first find()
  void offer(std::vector<ComplianceColumn> columns);

  /// All that are held, those offered and not refuted too.
  [[nodiscard]] std::vector<ComplianceColumn> columns() const;
  /// How many of them were worked out here.
  [[nodiscard]] std::size_t computed() const;
  /// Was an offered column refuted?
  [[nodiscard]] bool refuted() const;

 private:
  using Place = std::pair<std::size_t, std::size_t>;

  mutable std::mutex mutex_;
  std::map<Place, std::unique_ptr<const std::vector<float>>> held_;
  std::map<Place, std::vector<float>> offered_;
  std::map<std::size_t, bool> proven_;  ///< per solid
  std::size_t computed_ = 0;
  bool refuted_ = false;
};

/// Key of a scene's compliances, as a name: SHA-256 over the simulation version and the names and bytes of
/// its files.
std::string complianceKey(const std::vector<Asset>& assets);

/// The user's folder for them: what CALOT_CACHE names, else `calot` in XDG_CACHE_HOME or ~/.cache. None where
/// CALOT_CACHE is "off" or there is no home.
std::optional<std::filesystem::path> userCacheFolder();

struct CacheEntry {
  enum class State : std::uint8_t {
    usable,
    otherVersion,  ///< of another simulation version than this build's
    damaged,       ///< not what was written
    foreign,       ///< of another user, or others may write it: never read
    leftover,      ///< of a program that ended while it wrote
  };
  std::filesystem::path file;
  State state = State::damaged;
  std::string scene;  ///< its name
  std::uint32_t simulationVersion = 0;
  std::uint64_t bytes = 0;
  std::uint64_t columns = 0;
};

class ComplianceCache {
 public:
  /// @param folder need not be there yet
  explicit ComplianceCache(std::filesystem::path folder) : folder_(std::move(folder)) {}

  /// The columns kept under a key; none where there is no entry that can be read and is this user's own.
  [[nodiscard]] std::vector<ComplianceColumn> load(const std::string& key) const;
  /// Replaces the entry of a key; older entries go where all together exceed maxBytes.
  /// @returns false where it could not be written, which harms nothing
  bool save(const std::string& key, const std::string& scene, const std::vector<ComplianceColumn>& columns) const;

  /// All entries, by name. @throws Error (failure) where the folder is there and cannot be read
  [[nodiscard]] std::vector<CacheEntry> list() const;
  /// Removes entries, those of this build's version too or not, and what programs left half-written.
  /// @returns what was removed @throws Error (failure) where one cannot be
  std::vector<CacheEntry> clean(bool usableToo) const;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

  /// Total size of all entries (bytes): some twenty scenes.
  static constexpr std::uint64_t maxBytes = std::uint64_t{1} << 30U;

 private:
  [[nodiscard]] std::filesystem::path fileOf(const std::string& key) const;
  void makeRoom(const std::filesystem::path& newest) const;

  std::filesystem::path folder_;
};

}  // namespace calot::recorder
