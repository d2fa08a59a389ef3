// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/shared_compliances.h"

#include <cstring>

namespace calot::recorder {

namespace {

/// Bit for bit: 0 and -0 differ.
bool isSame(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

}  // namespace

const float* SharedCompliances::find(std::size_t solid, std::size_t node) {
  const std::lock_guard lock(mutex_);
  const Place place{solid, node};
  if (const auto at = held_.find(place); at != held_.end()) return at->second->data();
  const auto offered = offered_.find(place);
  if (offered == offered_.end() || !proven_[solid]) return nullptr;
  auto& held = held_[place];
  held = std::make_unique<const std::vector<float>>(std::move(offered->second));
  offered_.erase(offered);
  return held->data();
}

const float* SharedCompliances::keep(std::size_t solid, std::size_t node, std::vector<float> column) {
  const std::lock_guard lock(mutex_);
  const Place place{solid, node};
  if (const auto at = held_.find(place); at != held_.end()) return at->second->data();  // of another thread
  if (const auto offered = offered_.find(place); offered != offered_.end()) {
    proven_[solid] = isSame(offered->second, column);
    refuted_ = refuted_ || !proven_[solid];
    if (refuted_) {
      offered_.clear();
    } else {
      offered_.erase(offered);
    }
  }
  ++computed_;
  auto& held = held_[place];
  held = std::make_unique<const std::vector<float>>(std::move(column));
  return held->data();
}

void SharedCompliances::offer(std::vector<ComplianceColumn> columns) {
  const std::lock_guard lock(mutex_);
  for (ComplianceColumn& c : columns) offered_[{c.solid, c.node}] = std::move(c.value);
}

std::vector<ComplianceColumn> SharedCompliances::columns() const {
  const std::lock_guard lock(mutex_);
  std::vector<ComplianceColumn> all;
  const auto add = [&](const Place& place, const std::vector<float>& value) {
    all.push_back({static_cast<std::uint32_t>(place.first), static_cast<std::uint32_t>(place.second), value});
  };
  for (const auto& [place, value] : held_) add(place, *value);
  for (const auto& [place, value] : offered_) add(place, value);
  return all;
}

std::size_t SharedCompliances::computed() const {
  const std::lock_guard lock(mutex_);
  return computed_;
}

bool SharedCompliances::refuted() const {
  const std::lock_guard lock(mutex_);
  return refuted_;
}

}  // namespace calot::recorder
