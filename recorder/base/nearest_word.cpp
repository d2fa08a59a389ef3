// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/nearest_word.h"

#include <fmt/format.h>

#include <algorithm>

#include "recorder/base/text_words.h"

namespace calot::recorder {
namespace {

/// Longer words are no words of ours; comparing them would cost time that an input chooses.
constexpr std::size_t longestWord = 100;

}  // namespace

std::size_t wordDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t other = a[i - 1] == b[j - 1] ? 0 : 1;
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + other});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::string nearestWord(std::string_view word, const std::vector<std::string>& known) {
  if (word.empty() || word.size() > longestWord) return {};
  const std::string typed = lowerCase(word);
  std::string nearest, begun;
  std::size_t least = std::clamp<std::size_t>(typed.size() / 3, 1, 3) + 1, begins = 0;
  for (const std::string& one : known) {
    if (one == word) return {};
    if (one.empty() || one.size() > longestWord) continue;
    const std::string there = lowerCase(one);
    if (there.starts_with(typed)) {
      begun = one;
      ++begins;
    }
    // A word of which no letter is left is another one.
    if (const std::size_t distance = wordDistance(typed, there); distance < std::min(least, typed.size())) {
      least = distance;
      nearest = one;
    }
  }
  if (nearest.empty() && begins == 1) nearest = begun;
  return nearest;
}

std::string didYouMean(std::string_view word, const std::vector<std::string>& known) {
  const std::string nearest = nearestWord(word, known);
  return nearest.empty() ? nearest : fmt::format(" (did you mean \"{}\"?)", shown(nearest));
}

}  // namespace calot::recorder
