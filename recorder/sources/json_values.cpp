// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/json_values.h"

#include <array>
#include <cmath>
#include <utility>

namespace calot::recorder {
namespace {

struct ValueReader {
  const JsonPlace& place;
  const KeyRule& rule;

  void operator()(double* out) const { *out = place.number(rule); }
  void operator()(std::uint32_t* out) const { *out = place.integer(rule); }
  void operator()(int* out) const { *out = static_cast<int>(place.integer(rule)); }
  void operator()(bool* out) const { *out = place.boolean(); }
  void operator()(std::span<double> out) const {
    const std::vector<JsonPlace> items = place.list(out.size(), out.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = items[i].number(rule);
  }
  void operator()(Vec3* out) const { (*this)(std::span(out->data(), 3)); }
  void operator()(Quat* out) const {
    std::array<double, 4> q{};
    (*this)(std::span<double>(q));
    *out = Quat(q[0], q[1], q[2], q[3]);
    if (!(std::abs(out->norm() - 1.0) <= 1e-6)) place.fail("is no unit quaternion w x y z");
    out->normalize();
  }
  template <class T>
  void operator()(std::optional<T>* out) const {
    (*this)(&out->emplace());
  }
};

struct ValueWriter {
  nlohmann::ordered_json& out;
  const std::string& key;

  template <class T>
  void operator()(const T* value) const {
    out[key] = *value;
  }
  void operator()(std::span<const double> values) const { out[key] = std::vector(values.begin(), values.end()); }
  void operator()(const Vec3* v) const { (*this)(std::span(v->data(), 3)); }
  void operator()(const Quat* q) const { (*this)(std::array{q->w(), q->x(), q->y(), q->z()}); }
  template <class T>
  void operator()(const std::optional<T>* value) const {
    if (*value) (*this)(&**value);
  }
};

}  // namespace

ObjectRule ruleOf(std::string definition, const JsonValues& values) {
  ObjectRule rule{std::move(definition), {}};
  for (const JsonValue& v : values) rule.keys.push_back(v.rule);
  return rule;
}

void readValues(const JsonPlace& place, const JsonValues& values) {
  const ObjectRule rule = ruleOf("", values);
  const JsonObject object = place.object(rule);
  for (const JsonValue& v : values) {
    if (!object.has(v.rule.key)) continue;
    const JsonPlace at = object.at(v.rule.key);
    std::visit(ValueReader{at, v.rule}, v.value);
  }
}

nlohmann::ordered_json jsonOf(const JsonValues& values) {
  auto out = nlohmann::ordered_json::object();
  for (const JsonValue& v : values)
    std::visit([&](const auto& value) { ValueWriter{out, v.rule.key}(value); }, v.value);
  return out;
}

}  // namespace calot::recorder
