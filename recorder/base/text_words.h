// SPDX-License-Identifier: GPL-3.0-or-later
// Words and numbers of untrusted text files, and suggestions for a mistyped word.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace calot::recorder {

/// Words of one line, in turn.
class Words {
 public:
  /// @param comment ends the line; '\0': nothing does
  explicit Words(std::string_view line, char comment = '\0');

  /// @return an empty word at the end
  std::string_view next();

 private:
  std::string_view rest_;
};

/// Removes and returns the next line of a text, without its line break.
std::string_view takeLine(std::string_view& text);

/// With small letters for A to Z.
std::string lowerCase(std::string_view text);

/// A word for a message: short, its letters as they are, with '?' for what hides or turns text, for what lies from
/// U+FFF0 and for what is not UTF-8. @param most characters; "..." stands for what is cut off
std::string shown(std::string_view word, std::size_t most = 40);

/// Text of a file as UTF-8 without its byte order mark. UTF-16 (by its mark, or by the zeros of its first line) and
/// what is not UTF-8 (read as Latin-1) are converted. @param converted holds the text where it was, and outlives it
std::string_view decodedText(std::span<const std::byte> bytes, std::string& converted);

/// A word as a finite number. A leading '+' is allowed, hexadecimal is not.
/// @param[out] fault "\"x\" is not a number", or left as it is
/// @return 0 where there is a fault
double readFiniteNumber(std::string_view word, std::string& fault);

/// A word as a whole number of at most 18 digits, with a sign or none.
/// @param[out] fault as above
long long readWholeNumber(std::string_view word, std::string& fault);

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
