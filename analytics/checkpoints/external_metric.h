// SPDX-License-Identifier: GPL-3.0-or-later
// A metric that a user's own script computes (docs/how-to/own-metrics.md): beside the registry's checkpoints, never
// one of them.
#pragma once

#include <memory>
#include <string>

#include "analytics/checkpoints/definition.h"

namespace calot::analytics {

/// What a script declares of its metric, and which script it is.
struct ExternalMetric {
  /// Name, title, unit, direction and version are the script's; `unit` is displayed as it is.
  CheckpointDefinition definition;
  std::string sha256;  ///< of the script's bytes, hexadecimal: a version stands for one source

  bool operator==(const ExternalMetric& other) const {
    const CheckpointDefinition &a = definition, &b = other.definition;
    return sha256 == other.sha256 && a.name == b.name && a.version == b.version && a.title == b.title &&
           a.unit == b.unit && a.direction == b.direction;
  }
};

/// A shared metric, or none; equal where what is shared is equal.
class ExternalMetricRef {
 public:
  ExternalMetricRef() = default;
  explicit ExternalMetricRef(ExternalMetric metric)
      : metric_(std::make_shared<const ExternalMetric>(std::move(metric))) {}

  explicit operator bool() const { return metric_ != nullptr; }
  const ExternalMetric& operator*() const { return *metric_; }
  const ExternalMetric* operator->() const { return metric_.get(); }
  bool operator==(const ExternalMetricRef& other) const {
    return metric_ == other.metric_ || (metric_ && other.metric_ && *metric_ == *other.metric_);
  }

 private:
  std::shared_ptr<const ExternalMetric> metric_;
};

}  // namespace calot::analytics
