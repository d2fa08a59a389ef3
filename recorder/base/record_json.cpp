// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/record_json.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <cstring>

#include "recorder/base/json_reader.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {
namespace {

bool isKey(const Field& field) { return *field.name != '\0'; }

void checkKeys(const JsonPlace& place, const Record& record) {
  std::vector<std::string> known;
  for (const Field& field : record.fields) {
    if (isKey(field)) known.emplace_back(field.name);
  }
  for (const std::string& key : place.keys()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    JsonFaults::part([&] {
      place.named(key).fail(fmt::format("unknown key{}; known are {}", didYouMean(key, known), fmt::join(known, ", ")));
    });
  }
  for (const Field& field : record.fields) {
    if (field.required) JsonFaults::part([&] { static_cast<void>(place.at(field.name)); });
  }
}

/// Copies a plain value, or nothing where it is stored nowhere.
void copyInto(void* value, const void* from, std::size_t size) {
  if (value != nullptr) std::memcpy(value, from, size);
}

void readValue(const JsonPlace& place, const Field& field, const Access& access, void* value) {
  using Type = Access::Type;
  const auto store = [&](const auto& plain) { copyInto(value, &plain, access.size); };
  switch (access.type) {
    case Type::numbers: {
      std::vector<double> numbers;
      if (access.count == 0) {
        numbers.push_back(place.number(field.range));
      } else {
        for (const JsonPlace& part : place.list(access.count, access.count))
          numbers.push_back(part.number(field.range));
      }
      return copyInto(value, numbers.data(), access.size);
    }
    case Type::rotation: {
      double q[4];
      const std::vector<JsonPlace> parts = place.list(4, 4);
      for (std::size_t i = 0; i < 4; ++i) q[i] = parts[i].number(within(-1, 1));
      const Quat given(q[0], q[1], q[2], q[3]);
      if (!(std::abs(given.norm() - 1.0) <= 1e-6)) place.fail("is not a unit quaternion w x y z");
      return store(given.normalized());
    }
    case Type::integer:
      return store(place.integer(field.range));
    case Type::flag:
      return store(place.boolean());
    case Type::word:
      return store(place.word(field.words));
    case Type::text: {
      std::string text = place.text(field.text);
      if (value != nullptr) *static_cast<std::string*>(value) = std::move(text);
      return;
    }
    case Type::record:
      if (access.reset != nullptr) access.reset(value);
      return readRecord(place, access.record(), value);
    case Type::list: {
      std::size_t i = 0;
      for (const JsonPlace& item : place.list(field.least, field.most)) {
        void* const to = value == nullptr           ? nullptr
                         : access.append != nullptr ? access.append(value)
                                                    : access.itemAt(value, i++);
        JsonFaults::part([&] { readValue(item, field, *access.item, to); });
      }
      return;
    }
    case Type::bytes:
      return;
  }
}

}  // namespace

void readRecord(const JsonPlace& place, const Record& record, void* object) {
  if (std::none_of(record.fields.begin(), record.fields.end(), isKey)) return;
  checkKeys(place, record);
  for (const Field& field : record.fields) {
    if (!isKey(field) || !place.has(field.name)) continue;
    JsonFaults::part([&] {
      void* const value = field.value.get == nullptr ? nullptr : field.value.get(object);
      readValue(place.at(field.name), field, field.value, value);
    });
  }
}

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
