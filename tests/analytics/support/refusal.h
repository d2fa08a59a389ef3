// SPDX-License-Identifier: GPL-3.0-or-later
// That a call is refused, with which exit code, and in which words of one line.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "recorder/errors.h"

namespace calot::analytics::support {

/// @param words that the message must hold
template <class Call>
void expectRefusal(ExitCode code, const std::string& words, Call call) {
  try {
    call();
    ADD_FAILURE() << "no error; expected: " << words;
  } catch (const Error& error) {
    EXPECT_EQ(static_cast<int>(error.code()), static_cast<int>(code)) << error.what();
    EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
  }
}

}  // namespace calot::analytics::support
