// SPDX-License-Identifier: GPL-3.0-or-later
// Suggestions for a mistyped word.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace calot::recorder {

/// Optimal string alignment distance (Damerau-Levenshtein without overlaps): insertions, deletions, substitutions and
/// exchanges of adjacent characters that change one word into the other.
std::size_t wordDistance(std::string_view a, std::string_view b);

/// The known word nearest to `word`, where it is near enough to be meant: at most a third of the word's characters
/// differ (at least one, at most three), or the word is the beginning of exactly one known word. Of equally near words
/// the first. Upper and lower case are not distinguished.
/// @return empty: none is near, or the word itself is known
std::string nearestWord(std::string_view word, const std::vector<std::string>& known);

/// " (did you mean "x"?)", or empty.
std::string didYouMean(std::string_view word, const std::vector<std::string>& known);

}  // namespace calot::recorder
