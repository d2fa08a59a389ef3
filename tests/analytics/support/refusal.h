// SPDX-License-Identifier: GPL-3.0-or-later
// That a call is refused, with which exit code, and in which words of one line.
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "recorder/base/errors.h"

namespace calot::analytics::support {

/// @param words that the message must hold
/// @param remedies that the error must name; not given: any
template <class Call>
void expectRefusal(ErrorKind kind, const std::string& words, Call call,
                   const std::optional<std::vector<Remedy>>& remedies = std::nullopt) {
  try {
    call();
    ADD_FAILURE() << "no error; expected: " << words;
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.kind()), static_cast<int>(kind)) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    if (remedies) {
      EXPECT_EQ(error.remedies(), *remedies) << error.what();
    }
  }
}

}  // namespace calot::analytics::support
