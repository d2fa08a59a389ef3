// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/record_writer.h"

#include <cstring>

namespace calot::recorder {
namespace {

using Json = nlohmann::ordered_json;

Json writeValue(const Field& field, const Access& access, void* value) {
  using Type = Access::Type;
  std::uint32_t integer = 0;
  switch (access.type) {
    case Type::numbers: {
      const auto* numbers = static_cast<const double*>(value);
      return access.count == 0 ? Json(*numbers) : Json(std::vector<double>(numbers, numbers + access.count));
    }
    case Type::rotation: {
      const Quat& q = *static_cast<const Quat*>(value);
      return {q.w(), q.x(), q.y(), q.z()};
    }
    case Type::flag:
      return *static_cast<const bool*>(value);
    case Type::text:
      return *static_cast<const std::string*>(value);
    case Type::integer:
      std::memcpy(&integer, value, access.size);
      return integer;
    case Type::word:
      std::memcpy(&integer, value, access.size);
      for (const auto& [word, number] : field.words) {
        if (number == integer) return word;
      }
      return nullptr;
    case Type::record:
      return writeRecord(access.record(), value);
    case Type::list: {
      Json out = Json::array();
      for (std::size_t i = 0; i < access.items(value); ++i)
        out.push_back(writeValue(field, *access.item, access.itemAt(value, i)));
      return out;
    }
    case Type::bytes:
      break;
  }
  return nullptr;
}

Json onlyValue(const Field& field) {
  if (field.words.size() == 1) return field.words[0].first;
  if (field.value.type == Access::Type::integer && field.range.lower == field.range.upper)
    return static_cast<std::uint32_t>(field.range.lower);
  return nullptr;
}

}  // namespace

Json writeRecord(const Record& record, const void* object) {
  Json out = Json::object();
  for (const Field& field : record.fields) {
    const Access& access = field.value;
    if (*field.name == '\0' || (access.has != nullptr && !access.has(object))) continue;
    out[field.name] =
        access.get == nullptr ? onlyValue(field) : writeValue(field, access, access.get(const_cast<void*>(object)));
  }
  return out;
}

}  // namespace calot::recorder
