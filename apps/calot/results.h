// SPDX-License-Identifier: GPL-3.0-or-later
// Results as JSON, in one style (schemas/results.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string_view>

namespace calot::apps {

/// Head of every result: {"schema": "calot-<what>", "version": N}. The version is raised when a member
/// changes its meaning or goes; new members alone do not raise it.
/// @param body an object without these two members
[[nodiscard]] nlohmann::ordered_json resultOf(std::string_view what, const nlohmann::ordered_json& body);

/// Prints it on stdout, over several lines. Erases a line of progress first.
void printResult(std::string_view what, const nlohmann::ordered_json& body);

/// The same on one line, flushed: of results that come one after the other.
void printResultLine(std::string_view what, const nlohmann::ordered_json& body);

}  // namespace calot::apps
