// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/text_words.h"

#include <fmt/format.h>
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <utility>

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

namespace {

void appendUtf8(std::string& text, char32_t c) {
  const auto byte = [&](char32_t value) { text += static_cast<char>(value); };
  if (c < 0x80) return byte(c);
  if (c < 0x800) {
    byte(0xC0 | c >> 6U);
  } else {
    if (c < 0x10000) {
      byte(0xE0 | c >> 12U);
    } else {
      byte(0xF0 | c >> 18U);
      byte(0x80 | (c >> 12U & 0x3F));
    }
    byte(0x80 | (c >> 6U & 0x3F));
  }
  byte(0x80 | (c & 0x3F));
}

/// The first character of a text. @param[out] bytes that it takes; 0: no UTF-8
char32_t utf8Character(std::string_view text, std::size_t& bytes) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char lead = byte(0);
  bytes = lead < 0x80 ? 1 : lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  if (bytes > text.size()) bytes = 0;
  if (bytes < 2) return lead;
  char32_t c = lead & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80U) bytes = 0;
    if (bytes == 0) return lead;
    c = c << 6U | (byte(i) & 0x3FU);
  }
  constexpr char32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  if (c < least[bytes] || (c >= 0xD800 && c < 0xE000) || c > 0x10FFFF) bytes = 0;
  return c;
}

bool isUtf8(std::string_view text) {
  std::size_t bytes = 0;
  std::uint64_t eight = 0;
  while (!text.empty()) {
    for (; text.size() >= sizeof eight; text.remove_prefix(sizeof eight)) {  // most text is ASCII
      std::memcpy(&eight, text.data(), sizeof eight);
      if ((eight & 0x8080808080808080U) != 0) break;
    }
    if (text.empty()) break;
    utf8Character(text, bytes);
    if (bytes == 0) return false;
    text.remove_prefix(bytes);
  }
  return true;
}

/// Letters and marks; not controls, blanks of other widths, changes of direction, private characters (Unicode's
/// categories Cc, Cf, Co, Cs, Zl, Zp, Zs), nor anything from U+FFF0. Below that what no version of Unicode has assigned
/// yet is shown.
bool isShown(char32_t c) {
  if (c < 0x80) return c >= ' ' && c <= '~';
  constexpr std::pair<char32_t, char32_t> hidden[] = {
      {0x80, 0xA0},     {0xAD, 0xAD},     {0x600, 0x605},   {0x61C, 0x61C},   {0x6DD, 0x6DD},
      {0x70F, 0x70F},   {0x890, 0x891},   {0x8E2, 0x8E2},   {0x1680, 0x1680}, {0x180E, 0x180E},
      {0x2000, 0x206F}, {0x3000, 0x3000}, {0xD800, 0xF8FF}, {0xFEFF, 0xFEFF}, {0xFFF0, ~char32_t{0}}};
  return std::none_of(std::begin(hidden), std::end(hidden),
                      [&](const auto& range) { return c >= range.first && c <= range.second; });
}

}  // namespace

std::string shown(std::string_view word, std::size_t most) {
  std::string text;
  for (std::size_t count = 0; !word.empty() && count < most; ++count) {
    std::size_t bytes = 0;
    const char32_t c = utf8Character(word, bytes);
    text += bytes > 0 && isShown(c) ? std::string(word.substr(0, bytes)) : "?";
    word.remove_prefix(std::max<std::size_t>(bytes, 1));
  }
  return word.empty() ? text : text + "...";
}

std::string_view decodedText(std::span<const std::byte> bytes, std::string& converted) {
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const auto at = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const auto startsWith = [&](unsigned char a, unsigned char b) {
    return text.size() >= 2 && at(0) == a && at(1) == b;
  };
  const bool little = startsWith(0xFF, 0xFE) || (text.size() >= 4 && at(0) != 0 && at(1) == 0 && at(3) == 0);
  const bool big = startsWith(0xFE, 0xFF) || (text.size() >= 4 && at(0) == 0 && at(1) != 0 && at(2) == 0);
  if (little || big) {
    const auto unit = [&](std::size_t i) -> char32_t {
      return little ? static_cast<char32_t>(at(i + 1) << 8U | at(i)) : static_cast<char32_t>(at(i) << 8U | at(i + 1));
    };
    for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
      char32_t c = unit(i);
      if (c >= 0xD800 && c < 0xDC00 && i + 3 < text.size()) {
        c = 0x10000 + ((c - 0xD800) << 10U) + ((unit(i + 2) - 0xDC00) & 0x3FFU);
        i += 2;
      }
      appendUtf8(converted, c);
    }
    text = converted;
  } else if (!isUtf8(text)) {
    for (std::size_t i = 0; i < text.size(); ++i) appendUtf8(converted, at(i));
    text = converted;
  }
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.starts_with(mark)) text.remove_prefix(mark.size());
  return text;
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
