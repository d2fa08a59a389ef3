// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/structure/records/key_tables.h"

#include <fmt/format.h>

#include <algorithm>

namespace calot::structure {
namespace {

using Json = nlohmann::ordered_json;

std::string interval(const Json& number) {
  const bool lowerOpen = number.contains("exclusiveMinimum"), upperOpen = number.contains("exclusiveMaximum");
  return fmt::format("{}{}, {}{}", lowerOpen ? "(" : "[", number.at(lowerOpen ? "exclusiveMinimum" : "minimum").dump(),
                     number.at(upperOpen ? "exclusiveMaximum" : "maximum").dump(), upperOpen ? ")" : "]");
}

/// Pages of definitions.
struct Pages {
  const OnPage& onPage;
  const std::string& otherPage;
};

std::string valueOf(const Json& property, const Pages& pages) {
  if (property.contains("$ref")) {
    const std::string name = property.at("$ref").get<std::string>().substr(8);
    std::string anchor = name;
    std::transform(anchor.begin(), anchor.end(), anchor.begin(), [](unsigned char c) { return std::tolower(c); });
    return fmt::format("[{}]({}#{})", name, pages.onPage(name) ? "" : pages.otherPage, anchor);
  }
  if (property.contains("const")) return fmt::format("`{}`", property.at("const").get<std::string>());
  if (property.contains("enum")) {
    std::string words;
    for (const Json& word : property.at("enum")) words += (words.empty() ? "`" : ", `") + word.get<std::string>() + "`";
    return words;
  }
  const auto type = property.at("type").get<std::string>();
  if (type == "number") return interval(property);
  if (type == "integer") return "whole, " + interval(property);
  if (type == "boolean") return "true, false";
  if (type == "string") return fmt::format("text, {} bytes at most", property.at("maxLength").dump());
  const std::string least = property.at("minItems").dump(), most = property.at("maxItems").dump();
  return fmt::format("{} of {}", least == most ? least : least + " to " + most, valueOf(property.at("items"), pages));
}

std::string table(const Json& object, const Pages& pages) {
  std::string out = "| key | value | default | meaning |\n| --- | --- | --- | --- |\n";
  const Json& required = object.at("required");
  for (const auto& entry : object.at("properties").items()) {
    const Json& property = entry.value();
    const bool must = std::find(required.begin(), required.end(), entry.key()) != required.end();
    std::string meaning = property.at("description").get<std::string>();
    meaning.pop_back();
    out += fmt::format("| `{}` | {} | {} | {} |\n", entry.key(), valueOf(property, pages),
                       property.contains("default") ? property.at("default").dump()
                       : must                       ? "required"
                                                    : "",
                       meaning);
  }
  return out;
}

}  // namespace

std::string rootTable(const Json& schema, const OnPage& onPage, const std::string& otherPage) {
  return table(schema, {onPage, otherPage});
}

std::string keyTables(const Json& schema, const OnPage& onPage, const std::string& otherPage) {
  std::string out;
  for (const auto& entry : schema.at("$defs").items()) {
    if (!onPage(entry.key())) continue;
    out += fmt::format("\n## {}\n\n{}\n\n{}", entry.key(), entry.value().at("description").get<std::string>(),
                       table(entry.value(), {onPage, otherPage}));
  }
  return out;
}

}  // namespace calot::structure
