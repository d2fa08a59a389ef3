// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of the documentation: the keys of a file, from its published schema.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace calot::structure {

/// A section for each kind of object, in the schema's order: key, value, default, meaning.
std::string keyTables(const nlohmann::ordered_json& schema);

}  // namespace calot::structure
