// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/text_words.h"

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace calot::recorder {
namespace {

constexpr std::string_view blanks = " \t\r\v\f";

/// Is a whole word a number? Both ways give the nearest double.
bool parseNumber(std::string_view word, double& value) {
#ifdef __cpp_lib_to_chars
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && end == word.data() + word.size();
#else
  // A library that has no from_chars of doubles: that of WebAssembly, whose strtod knows one locale.
  if (word.empty() || word.front() == '+' || word.find_first_of(" \t\n\v\f\rxX") != std::string_view::npos)
    return false;
  const std::string text(word);
  char* end = nullptr;
  errno = 0;
  value = std::strtod(text.c_str(), &end);
  return errno == 0 && end == text.c_str() + text.size();
#endif
}

}  // namespace

Words::Words(std::string_view line, char comment)
    : rest_(comment == '\0' ? line : line.substr(0, line.find(comment))) {}

std::string_view Words::next() {
  rest_.remove_prefix(std::min(rest_.find_first_not_of(blanks), rest_.size()));
  const std::size_t end = std::min(rest_.find_first_of(blanks), rest_.size());
  const std::string_view word = rest_.substr(0, end);
  rest_.remove_prefix(end);
  return word;
}

std::string_view takeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

std::string lowerCase(std::string_view text) {
  std::string out(text);
  for (char& c : out) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return out;
}

std::string shown(std::string_view word) {
  std::string text(word.substr(0, 40));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return word.size() > 40 ? text + "..." : text;
}

double readFiniteNumber(std::string_view word, std::string& fault) {
  const std::string_view whole = word;
  double value = 0.0;
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  if (!parseNumber(word, value)) {
    fault = fmt::format("\"{}\" is not a number", shown(whole));
  } else if (!std::isfinite(value)) {
    fault = fmt::format("\"{}\" is not a finite number", shown(whole));
  } else {
    return value;
  }
  return 0.0;
}

long long readWholeNumber(std::string_view word, std::string& fault) {
  const std::string_view whole = word;
  long long value = 0;
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code == std::errc() && end == word.data() + word.size() && std::abs(value) < 1'000'000'000'000'000'000LL) {
    return value;
  }
  fault = fmt::format("\"{}\" is not a whole number", shown(whole));
  return 0;
}

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
