// SPDX-License-Identifier: GPL-3.0-or-later
// Shares of a list of recordings: each machine assesses one into a database of its own (docs/how-to/cluster.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace calot::analytics {

/// One share of several, counted from 1: "3/8".
struct Share {
  std::uint32_t number = 1, of = 1;
  bool operator==(const Share&) const = default;
};

/// Largest number of shares; no cluster runs a larger array of jobs.
inline constexpr std::uint32_t maxShares = 1'000'000;

/// Reads "3/8". @throws Error (invalid)
Share shareNamed(const std::string& text);

/// Indices of the files in a share, ascending. Sorted by size and name, files are dealt like cards, forth and back, so
/// that shares differ by at most one file and hold as many long recordings each. Depends on the list alone.
/// @param files size (bytes) and name of each
std::vector<std::size_t> indicesOf(const Share& share, const std::vector<std::pair<std::uint64_t, std::string>>& files);

/// Files of a share. @throws nothing: a file that is gone counts as empty, and judging it reports it.
std::vector<std::filesystem::path> filesOf(const Share& share, const std::vector<std::filesystem::path>& files);

}  // namespace calot::analytics
