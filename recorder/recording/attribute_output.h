// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

namespace calot::recorder {

/// Visitor for visitAttributes() that assigns each attribute to `out[name]`: of a JSON object, of a dictionary.
template <class Out>
struct AttributesTo {
  Out& out;

  template <class T>
  void operator()(const char* name, const T& value) {
    out[name] = value;
  }
  template <class T>
  void constant(const char* name, const T& value) {
    out[name] = value;
  }
  template <class T, std::size_t N>
  void choice(const char* name, const T& value, const std::array<const char*, N>& names) {
    out[name] = names[static_cast<std::size_t>(value)];
  }
};
template <class Out>
AttributesTo(Out&) -> AttributesTo<Out>;

}  // namespace calot::recorder
