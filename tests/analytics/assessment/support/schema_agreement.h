// SPDX-License-Identifier: GPL-3.0-or-later
// That a reader's rules and the published schema say the same.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "recorder/base/json_reader.h"

namespace calot::analytics::support {

inline std::vector<std::byte> bytesOf(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

inline nlohmann::json jsonOf(const std::string& file) {
  std::ifstream in(std::string(CALOT_SOURCE_DIR) + "/" + file);
  EXPECT_TRUE(in) << file;
  return nlohmann::json::parse(in);
}

inline void expectAgreement(const std::vector<recorder::ObjectRule>& rules, const std::string& schemaFile) {
  const nlohmann::json schema = jsonOf(schemaFile);
  for (const recorder::ObjectRule& rule : rules) {
    SCOPED_TRACE(rule.definition);
    const nlohmann::json& object = rule.definition.empty() ? schema : schema.at("$defs").at(rule.definition);
    std::set<std::string> keys, required, schemaKeys;
    for (const recorder::KeyRule& key : rule.keys) {
      keys.insert(key.key);
      if (key.required) required.insert(key.key);
      const nlohmann::json& property = object.at("properties").at(key.key);
      const std::string type = property.value("type", "");
      if (type != "number" && type != "integer") continue;
      EXPECT_EQ(property.at(key.lowerOpen ? "exclusiveMinimum" : "minimum").get<double>(), key.lower) << key.key;
      EXPECT_EQ(property.at(key.upperOpen ? "exclusiveMaximum" : "maximum").get<double>(), key.upper) << key.key;
    }
    for (const auto& property : object.at("properties").items()) schemaKeys.insert(property.key());
    EXPECT_EQ(keys, schemaKeys);
    EXPECT_EQ(required, object.at("required").get<std::set<std::string>>());
    EXPECT_EQ(object.at("additionalProperties"), false);
  }
}

}  // namespace calot::analytics::support
