// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of messages and reasons by their values, not by their words.
#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <set>
#include <string>
#include <vector>

namespace calot {

/// True where a text holds a value that is no part of a longer word or number.
inline bool holdsToken(const std::string& text, const std::string& value) {
  const auto alnum = [&](std::size_t i) {
    return i < text.size() && std::isalnum(static_cast<unsigned char>(text[i]));
  };
  const auto continues = [&](std::size_t edge, std::size_t next, std::size_t beyond) {
    return alnum(edge) && (alnum(next) || (next < text.size() && text[next] == '.' && alnum(beyond)));
  };
  for (std::size_t at = text.find(value); at != std::string::npos; at = text.find(value, at + 1)) {
    const std::size_t last = at + value.size() - 1;
    if (!continues(at, at - 1, at - 2) && !continues(last, last + 1, last + 2)) return true;
  }
  return false;
}

/// A text of any number of lines holds the values.
inline void expectHolds(const std::string& text, const std::vector<std::string>& values) {
  for (const std::string& value : values) EXPECT_TRUE(holdsToken(text, value)) << value << " is not in: " << text;
}

/// A message is one line and names the values.
inline void expectNames(const std::string& message, const std::vector<std::string>& values) {
  EXPECT_FALSE(message.empty());
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  expectHolds(message, values);
}

/// Different faults have different messages.
inline void expectDistinct(const std::vector<std::string>& messages) {
  EXPECT_EQ(std::set(messages.begin(), messages.end()).size(), messages.size()) << testing::PrintToString(messages);
  for (const std::string& message : messages) expectNames(message, {});
}

}  // namespace calot
