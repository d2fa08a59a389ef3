// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/structure/records/json_schema.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace calot::structure {
namespace {

using Json = nlohmann::ordered_json;
using Type = Access::Type;

Json numberOf(double value) {
  if (std::abs(value) < 1e15 && value == std::floor(value)) return static_cast<std::int64_t>(value);
  return value;
}

Json listOf(Json items, std::size_t least, std::size_t most) {
  return {{"type", "array"}, {"items", std::move(items)}, {"minItems", least}, {"maxItems", most}};
}

class Schema {
 public:
  explicit Schema(const std::vector<const Record*>& elsewhere) : elsewhere_(elsewhere) {}

  Json object(const Record& record) {
    Json required = Json::array(), properties = Json::object();
    for (const Field& field : record.fields) {
      if (*field.name == '\0') continue;
      if (field.required) required.push_back(field.name);
      properties[field.name] = property(field, record.defaults);
    }
    Json out{{"description", std::string(record.meaning) + "."}, {"type", "object"}, {"additionalProperties", false}};
    out["required"] = required;
    out["properties"] = properties;
    return out;
  }

  Json definitions;

 private:
  Json property(const Field& field, const void* defaults) {
    const bool hasUnit = *field.unit != '\0' && std::strcmp(field.unit, "1") != 0;
    Json out{{"description", std::string(field.meaning) + (hasUnit ? std::string(" (") + field.unit + ")." : ".")}};
    out.update(type(field, field.value));
    if (!field.required && field.value.get != nullptr && field.value.has == nullptr) {
      const Json value = defaultOf(field, field.value.get(const_cast<void*>(defaults)));
      if (!value.is_null()) out["default"] = value;
    }
    return out;
  }

  Json type(const Field& field, const Access& access) {
    switch (access.type) {
      case Type::numbers:
        if (access.count > 0) return listOf(number(field, "number"), access.count, access.count);
        return number(field, "number");
      case Type::rotation:
        return listOf({{"type", "number"}, {"minimum", -1}, {"maximum", 1}}, 4, 4);
      case Type::integer:
        return number(field, "integer");
      case Type::flag:
        return {{"type", "boolean"}};
      case Type::text: {
        Json out{{"type", "string"}, {"minLength", 1}, {"maxLength", field.text.longest}};
        if (field.text.pattern != nullptr) out["pattern"] = field.text.pattern;
        return out;
      }
      case Type::word: {
        Json words = Json::array();
        for (const auto& [word, number] : field.words) words.push_back(word);
        return words.size() == 1 ? Json{{"const", words[0]}} : Json{{"enum", words}};
      }
      case Type::record:
        return {{"$ref", "#/$defs/" + define(access.record())}};
      case Type::list:
        return listOf(type(field, *access.item), field.least, field.most);
      case Type::bytes:
        break;
    }
    return {};
  }

  static Json number(const Field& field, const char* type) {
    const Range& range = field.range;
    return {{"type", type},
            {range.lowerOpen ? "exclusiveMinimum" : "minimum", numberOf(range.lower)},
            {range.upperOpen ? "exclusiveMaximum" : "maximum", numberOf(range.upper)}};
  }

  static Json defaultOf(const Field& field, const void* value) {
    const auto* numbers = static_cast<const double*>(value);
    std::uint32_t integer = 0;
    switch (field.value.type) {
      case Type::numbers: {
        if (field.value.count == 0) return *numbers < field.range.lower ? Json() : numberOf(*numbers);
        Json out = Json::array();
        for (std::size_t i = 0; i < field.value.count; ++i) out.push_back(numberOf(numbers[i]));
        return out;
      }
      case Type::flag:
        return *static_cast<const bool*>(value);
      case Type::integer:
      case Type::word:
        std::memcpy(&integer, value, field.value.size);
        break;
      default:
        return {};
    }
    if (field.value.type == Type::integer) return integer;
    const auto word =
        std::find_if(field.words.begin(), field.words.end(), [&](const auto& w) { return w.second == integer; });
    return word == field.words.end() ? Json() : Json(word->first);
  }

  std::string define(const Record& record) {
    const std::string name = record.name;
    if (definitions.contains(name)) return name;
    definitions[name] = nullptr;  // its place is that of its first use
    const auto other =
        std::find_if(elsewhere_.begin(), elsewhere_.end(), [&](const Record* r) { return r->name == name; });
    Json made = object(other == elsewhere_.end() ? record : **other);
    definitions[name] = std::move(made);
    return name;
  }

  const std::vector<const Record*>& elsewhere_;
};

}  // namespace

Json jsonSchema(const std::string& title, const std::string& page, const Record& root,
                const std::vector<const Record*>& elsewhere) {
  Schema schema(elsewhere);
  Json out{{"$schema", "https://json-schema.org/draft/2020-12/schema"}, {"title", title}};
  out.update(schema.object(root));
  out["description"] = std::string(root.meaning) + ". " + page + " explains it.";
  if (!schema.definitions.is_null()) out["$defs"] = schema.definitions;
  return out;
}

}  // namespace calot::structure
