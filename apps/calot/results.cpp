// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/results.h"

#include <fmt/format.h>

#include <cstdio>
#include <iostream>

#include "apps/calot/environment.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

/// Version of every result. A command whose members change gets its own version here.
constexpr int resultVersion = 1;

void print(const std::string& text) {
  Progress::erase();
  // In order with what was printed through the other of the two streams.
  std::cout << std::flush;
  fmt::print("{}\n", text);
  if (std::fflush(stdout) != 0) throw Error(ErrorKind::failure, "standard output cannot be written");
}

}  // namespace

nlohmann::ordered_json resultOf(std::string_view what, const nlohmann::ordered_json& body) {
  nlohmann::ordered_json result{{"schema", fmt::format("calot-{}", what)}, {"version", resultVersion}};
  for (const auto& member : body.items()) result[member.key()] = member.value();
  return result;
}

void printResult(std::string_view what, const nlohmann::ordered_json& body) {
  print(resultOf(what, body).dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void printResultLine(std::string_view what, const nlohmann::ordered_json& body) {
  print(resultOf(what, body).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace calot::apps
