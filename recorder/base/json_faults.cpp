// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/json_faults.h"

#include <algorithm>
#include <string_view>

namespace calot::recorder {

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
