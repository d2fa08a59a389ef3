// SPDX-License-Identifier: GPL-3.0-or-later
// How the recordings of a cohort or folder are divided among machines (docs/how-to/cluster.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace calot::analytics {

/// One share of several, counted from 1: "3/8".
struct Shard {
  std::uint32_t number = 1, of = 1;
  bool operator==(const Shard&) const = default;
};

/// More than any cluster runs as one array of jobs.
inline constexpr std::uint32_t maxShards = 1'000'000;

/// Reads "3/8". @throws Error (invalid)
Shard shardNamed(const std::string& text);

/// What decides to which share a recording belongs.
struct Dealt {
  std::string kind;        ///< recordings of one kind take as long for the same size: a scene; may be empty
  std::uint64_t size = 0;  ///< steps, or bytes
  std::string name;        ///< of the recording, unique
};

/// Which of the recordings belong to which share: indices into `recordings`, ascending, for each share. Sorted by kind
/// and size, they are dealt like cards, forth and back; each share so has as many of each kind and length as any
/// other, give or take one. Depends on nothing but the list.
std::vector<std::vector<std::size_t>> deal(const std::vector<Dealt>& recordings, std::uint32_t shares);

/// Digest of a list: shares of different lists do not make up a whole.
std::string digestOf(const std::vector<Dealt>& recordings);

}  // namespace calot::analytics
