// SPDX-License-Identifier: GPL-3.0-or-later
// Output of `calot inspect`: the members of its JSON, under headings.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace calot::apps {

/// @param recording as `calot inspect --json` prints it @param columns of a line
std::string inspectText(const nlohmann::ordered_json& recording, std::size_t columns);

}  // namespace calot::apps
