// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/json_reader.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <regex>
#include <set>
#include <string_view>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {
namespace {

constexpr std::size_t maxFile = std::size_t{4} << 20U;
constexpr int deepest = 32;

std::string quoted(const std::string& text) { return fmt::format("\"{}\"", shown(text, 60)); }

std::string lineAndColumn(std::span<const std::byte> bytes, std::size_t at) {
  std::size_t line = 1, column = 1;
  for (std::size_t i = 0; i + 1 < at && i < bytes.size(); ++i) {
    if (bytes[i] == std::byte{'\n'}) {
      ++line;
      column = 1;
    } else {
      ++column;
    }
  }
  return fmt::format("line {}, column {}", line, column);
}

std::string escaped(const std::string& key) {
  std::string out;
  for (const char c : shown(key, 80)) {
    if (c == '~')
      out += "~0";
    else if (c == '/')
      out += "~1";
    else
      out += c;
  }
  return out;
}

std::string rangeOf(const Range& rule) {
  return fmt::format("{}{}, {}{}", rule.lowerOpen ? '(' : '[', rule.lower, rule.upper, rule.upperOpen ? ')' : ']');
}

bool inside(double value, const Range& rule) {
  return std::isfinite(value) && (rule.lowerOpen ? value > rule.lower : value >= rule.lower) &&
         (rule.upperOpen ? value < rule.upper : value <= rule.upper);
}

}  // namespace

nlohmann::json parseStrictJson(std::span<const std::byte> bytes, const std::string& file) {
  if (bytes.empty()) throw Error(ErrorKind::damaged, Where{file}, "the file is empty");
  if (bytes.size() > maxFile) {
    throw Error(ErrorKind::damaged, Where{file},
                fmt::format("{} bytes; such a file has at most {}", bytes.size(), maxFile));
  }
  std::vector<std::set<std::string>> keys;
  std::string fault;
  const auto watch = [&](int depth, nlohmann::json::parse_event_t event, nlohmann::json& parsed) {
    using Event = nlohmann::json::parse_event_t;
    if (depth > deepest)
      throw Error(ErrorKind::damaged, Where{file}, fmt::format("nested deeper than {} levels", deepest));
    if (event == Event::object_start) {
      keys.emplace_back();
    } else if (event == Event::object_end) {
      keys.pop_back();
    } else if (event == Event::key) {
      const std::string key = parsed.get<std::string>();
      if (!keys.back().insert(key).second && fault.empty())
        fault = fmt::format("the key {} is given twice", quoted(key));
    }
    return true;
  };
  const auto* begin = reinterpret_cast<const char*>(bytes.data());
  nlohmann::json value;
  try {
    value = nlohmann::json::parse(begin, begin + bytes.size(), watch);
  } catch (const nlohmann::json::parse_error& e) {
    throw Error(ErrorKind::damaged, Where{file}, fmt::format("not JSON at {}", lineAndColumn(bytes, e.byte)));
  } catch (const nlohmann::json::exception&) {
    throw Error(ErrorKind::damaged, Where{file}, "a number is larger than a double holds");
  }
  if (!fault.empty()) throw Error(ErrorKind::damaged, Where{file}, fault);
  return value;
}

void JsonPlace::fail(const std::string& fault) const {
  throw Error(ErrorKind::damaged, Where{file_, pointer_.empty() ? "/" : pointer_}, fault);
}

bool JsonPlace::has(const std::string& key) const { return value_->contains(key); }

JsonPlace JsonPlace::named(const std::string& key) const {
  return {has(key) ? (*value_)[key] : *value_, file_, pointer_ + "/" + escaped(key)};
}

JsonPlace JsonPlace::at(const std::string& key) const {
  static_cast<void>(keys());
  if (!has(key)) fail(fmt::format("the key \"{}\" is missing", key));
  return named(key);
}

std::vector<std::string> JsonPlace::keys() const {
  if (!value_->is_object()) fail(fmt::format("an object is expected, not {}", value_->type_name()));
  std::vector<std::string> out;
  for (const auto& entry : value_->items()) out.push_back(entry.key());
  return out;
}

std::vector<JsonPlace> JsonPlace::list(std::size_t least, std::size_t most) const {
  if (!value_->is_array()) fail(fmt::format("a list is expected, not {}", value_->type_name()));
  if (value_->size() < least || value_->size() > most) {
    fail(fmt::format("{} entries; from {} to {} are allowed", value_->size(), least, most));
  }
  std::vector<JsonPlace> places;
  for (std::size_t i = 0; i < value_->size(); ++i)
    places.emplace_back((*value_)[i], file_, fmt::format("{}/{}", pointer_, i));
  return places;
}

std::string JsonPlace::text(std::size_t longest) const {
  if (!value_->is_string()) fail(fmt::format("text is expected, not {}", value_->type_name()));
  auto text = value_->get<std::string>();
  if (text.empty()) fail("the text is empty");
  if (text.size() > longest) fail(fmt::format("the text has {} bytes; at most {} are allowed", text.size(), longest));
  if (std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; })) {
    fail("the text holds control characters");
  }
  return text;
}

std::string JsonPlace::text(const TextRule& rule) const {
  std::string found = text(rule.longest);
  if (rule.pattern != nullptr && !std::regex_match(found, std::regex(rule.pattern))) fail(rule.wanted);
  return found;
}

std::uint32_t JsonPlace::word(const FieldWords& words) const {
  const std::string given = text(maxWord);
  std::vector<std::string> known;
  for (const auto& [name, number] : words) {
    if (name == given) return number;
    known.push_back(name);
  }
  if (known.size() == 1) fail(fmt::format("\"{}\" is expected", known[0]));
  std::sort(known.begin(), known.end());
  fail(fmt::format("unknown word{}; known are {}", didYouMean(given, known), fmt::join(known, ", ")));
}

bool JsonPlace::boolean() const {
  if (!value_->is_boolean()) fail(fmt::format("true or false is expected, not {}", value_->type_name()));
  return value_->get<bool>();
}

double JsonPlace::number(const Range& range) const {
  if (!value_->is_number()) fail(fmt::format("a number is expected, not {}", value_->type_name()));
  const auto value = value_->get<double>();
  if (!inside(value, range)) fail(fmt::format("{} is not in {}", value, rangeOf(range)));
  return value;
}

std::uint32_t JsonPlace::integer(const Range& range) const {
  if (!value_->is_number_integer()) fail("a whole number is expected");
  const double value = number(range);
  return static_cast<std::uint32_t>(value);
}

Vec3 JsonPlace::vector(const Range& range) const {
  const std::vector<JsonPlace> parts = list(3, 3);
  return {parts[0].number(range), parts[1].number(range), parts[2].number(range)};
}

namespace {

thread_local JsonFaults* noting = nullptr;

}  // namespace

JsonFaults::JsonFaults() : outer_(noting) { noting = this; }

JsonFaults::~JsonFaults() { noting = outer_; }

void JsonFaults::note(const Error& fault) {
  const bool known = std::any_of(found_.begin(), found_.end(),
                                 [&](const Error& e) { return std::string_view(e.what()) == fault.what(); });
  if (!known) found_.push_back(fault);
}

bool JsonFaults::at(std::initializer_list<std::string_view> pointers) {
  return noting != nullptr && std::any_of(noting->found_.begin(), noting->found_.end(), [&](const Error& fault) {
           const std::string place = fault.where().place + "/";
           return std::any_of(pointers.begin(), pointers.end(),
                              [&](std::string_view p) { return place.starts_with(std::string(p) + "/"); });
         });
}

void JsonFaults::report(const Error& fault) {
  if (noting == nullptr) throw fault;
  noting->note(fault);
}

}  // namespace calot::recorder
