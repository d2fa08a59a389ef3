// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/shards/shard.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>
#include <tuple>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "sim/math/fields.h"

namespace calot::analytics {

Shard shardNamed(const std::string& text) {
  Shard shard;
  const char *at = text.data(), *end = at + text.size();
  const auto number = [&](std::uint32_t& out) {
    const auto [next, error] = std::from_chars(at, end, out);
    at = next;
    return error == std::errc();
  };
  const bool read = number(shard.number) && at != end && *at++ == '/' && number(shard.of) && at == end;
  if (!read || shard.of < 1 || shard.of > maxShards || shard.number < 1 || shard.number > shard.of) {
    throw Error(ErrorKind::invalid, fmt::format("'{}' is no shard: write 3/8 for the third of eight (at most {})",
                                                recorder::shown(text), maxShards));
  }
  return shard;
}

std::vector<std::vector<std::size_t>> deal(const std::vector<Dealt>& recordings, std::uint32_t shares) {
  std::vector<std::size_t> order(recordings.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    const Dealt &x = recordings[a], &y = recordings[b];
    return std::tie(x.kind, y.size, x.name) < std::tie(y.kind, x.size, y.name);
  });
  std::vector<std::vector<std::size_t>> dealt(shares);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t round = i / shares, place = i % shares;
    dealt[round % 2 == 0 ? place : shares - 1 - place].push_back(order[i]);
  }
  for (std::vector<std::size_t>& share : dealt) std::sort(share.begin(), share.end());
  return dealt;
}

std::string digestOf(const std::vector<Dealt>& recordings) {
  DigestStream digest;
  for (const Dealt& r : recordings) {
    const std::string text = fmt::format("{}\n{}\n{}\n", r.kind, r.size, r.name);
    digest.append(text.data(), text.size());
  }
  return fmt::format("{:016x}", digest.value());
}

}  // namespace calot::analytics
