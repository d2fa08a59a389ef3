// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/share.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>
#include <system_error>
#include <tuple>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {

Share shareNamed(const std::string& text) {
  Share share;
  const char *at = text.data(), *end = at + text.size();
  const auto number = [&](std::uint32_t& out) {
    const auto [next, error] = std::from_chars(at, end, out);
    at = next;
    return error == std::errc();
  };
  const bool read = number(share.number) && at != end && *at++ == '/' && number(share.of) && at == end;
  if (!read || share.of < 1 || share.of > maxShares || share.number < 1 || share.number > share.of) {
    throw Error(ErrorKind::invalid, fmt::format("'{}' is not a share: write 3/8 for the third of eight (at most {})",
                                                recorder::shown(text), maxShares));
  }
  return share;
}

std::vector<std::size_t> indicesOf(const Share& share,
                                   const std::vector<std::pair<std::uint64_t, std::string>>& files) {
  std::vector<std::size_t> order(files.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return std::tie(files[b].first, files[a].second) < std::tie(files[a].first, files[b].second);
  });
  std::vector<std::size_t> own;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::size_t round = i / share.of, place = i % share.of;
    if ((round % 2 == 0 ? place : share.of - 1 - place) + 1 == share.number) own.push_back(order[i]);
  }
  std::sort(own.begin(), own.end());
  return own;
}

std::vector<std::filesystem::path> filesOf(const Share& share, const std::vector<std::filesystem::path>& files) {
  std::vector<std::pair<std::uint64_t, std::string>> sized;
  for (const std::filesystem::path& file : files) {
    std::error_code gone;
    const std::uintmax_t bytes = std::filesystem::file_size(file, gone);
    sized.emplace_back(gone ? 0 : bytes, file.string());
  }
  std::vector<std::filesystem::path> own;
  for (const std::size_t i : indicesOf(share, sized)) own.push_back(files[i]);
  return own;
}

}  // namespace calot::analytics
