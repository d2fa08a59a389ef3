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

std::size_t JsonFaults::count() { return noting == nullptr ? 0 : noting->found_.size(); }

void JsonFaults::report(const Error& fault) {
  if (noting == nullptr) throw fault;
  noting->note(fault);
}

}  // namespace calot::recorder
