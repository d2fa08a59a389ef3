// SPDX-License-Identifier: GPL-3.0-or-later
// Checks of errors by kind, location and values: sentences can be mended without a change of tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <concepts>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/errors.h"
#include "tests/support/message.h"

namespace calot {

/// Input and the fault that it is refused with.
struct BadInput {
  std::string text;
  std::string where;
  std::vector<std::string> values;
};

/// The error that a call throws; empty where it throws none.
template <std::invocable Call>
std::optional<Error> caught(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// @param where file and place, "a.csv: line 3"; empty: any
/// @param values numbers and names that the message holds behind the place
inline void expectFault(ErrorKind kind, const std::string& where, const std::vector<std::string>& values,
                        const std::optional<Error>& error) {
  if (!error) {
    ADD_FAILURE() << "no error: " << where << " " << testing::PrintToString(values);
    return;
  }
  const std::string message = error->what();
  EXPECT_EQ(static_cast<int>(error->kind()), static_cast<int>(kind)) << message;
  const std::size_t fault = where.empty() ? 0 : where.size() + 2;
  if (!where.empty()) {
    EXPECT_EQ(message.substr(0, fault), where + ": ");
    EXPECT_GE(error->fault().size() + fault, message.size()) << message << ": a place that was not expected";
  }
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  expectNames(message.substr(std::min(fault, message.size())), values);
}

template <std::invocable Call>
void expectFault(ErrorKind kind, const std::string& where, const std::vector<std::string>& values, Call call) {
  expectFault(kind, where, values, caught(call));
}

/// @param remedies that the error names, no more and no fewer
inline void expectFault(ErrorKind kind, const std::string& where, const std::vector<std::string>& values,
                        const std::optional<Error>& error, const std::vector<Remedy>& remedies) {
  expectFault(kind, where, values, error);
  if (error) {
    EXPECT_EQ(error->remedies(), remedies) << error->what();
  }
}

template <std::invocable Call>
void expectFault(ErrorKind kind, const std::string& where, const std::vector<std::string>& values, Call call,
                 const std::vector<Remedy>& remedies) {
  expectFault(kind, where, values, caught(call), remedies);
}

}  // namespace calot
