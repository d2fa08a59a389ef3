// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of the documentation: the keys of a file, from its published schema.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace calot::structure {

/// Does a page have the definition of an object? Other definitions stand on the other page.
using OnPage = std::function<bool(const std::string& definition)>;

/// A section for each kind of object of a page, in the schema's order: key, value, default, meaning.
std::string keyTables(const nlohmann::ordered_json& schema, const OnPage& onPage, const std::string& otherPage);

/// The table of the file itself.
std::string rootTable(const nlohmann::ordered_json& schema, const OnPage& onPage, const std::string& otherPage);

}  // namespace calot::structure
