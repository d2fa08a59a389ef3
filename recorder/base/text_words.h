// SPDX-License-Identifier: GPL-3.0-or-later
// Words and numbers of untrusted text files.
#pragma once

#include <string>
#include <string_view>

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

/// A word for a message: short, and without control characters.
std::string shown(std::string_view word);

/// A word as a finite number. A leading '+' is allowed, hexadecimal is not.
/// @param[out] fault "\"x\" is not a number", or left as it is
/// @return 0 where there is a fault
double readFiniteNumber(std::string_view word, std::string& fault);

/// A word as a whole number of at most 18 digits, with a sign or none.
/// @param[out] fault as above
long long readWholeNumber(std::string_view word, std::string& fault);

}  // namespace calot::recorder
