// SPDX-License-Identifier: GPL-3.0-or-later
// Declaration of a checkpoint, and of a script's own metric (docs/how-to/own-metrics.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace calot::analytics {

/// Better direction. `none`: the figure describes, it does not judge.
enum class Direction : std::uint8_t { none, lower, higher };

/// Origin of a value (section 6 of the design). Numbers are stored and never reused.
enum class Origin : std::uint8_t {
  resimulated = 0,  ///< the simulation ran again, bit for bit, in the same simulation version
  observables = 1,  ///< recorded StepResults and forces, read by any later software
  samples = 2,      ///< motion of the operator's hands alone (the real tip)
  external = 3,     ///< a user's own script (ExternalMetric)
};

/// Subjects of the figure: once for the attempt, for each hand, organ of the scene, phase of the procedure, or
/// hand and phase.
enum class Aggregation : std::uint8_t { attempt, hand, organ, phase, handAndPhase };

/// `running`: known after every step. `final`: its filter looks ahead, so before the end it is provisional.
enum class Finality : std::uint8_t { running, final };

/// Values that a figure can have, besides being finite.
enum class Domain : std::uint8_t { notNegative, whole, any };  ///< `whole`: a count

/// The name of a value in a list by number; "unknown" beyond it.
template <class Enum>
std::string nameIn(std::initializer_list<const char*> names, Enum value) {
  const auto at = static_cast<std::size_t>(value);
  return at < names.size() ? names.begin()[at] : "unknown";
}

std::string nameOf(Direction direction);      ///< "none", "lower", "higher"
std::string nameOf(Origin origin);            ///< "re-simulated", "observables", "samples", "external"
std::string nameOf(Aggregation aggregation);  ///< "attempt", "hand", "organ", "phase", "hand and phase"
std::string nameOf(Finality finality);        ///< "running", "final"

/// Declaration of a checkpoint.
struct CheckpointDefinition {
  std::string name = {};   ///< "path-length": key in the database, never reused for another meaning
  std::string title = {};  ///< "Path length of the instrument's tip"
  std::string unit = {};   ///< SI, of stored values: "s", "m", "N"; a row's may follow from displayUnit, or is "1"
  std::string displayUnit = {};  ///< at the edges: "mm"
  double displayFactor = 1.0;    ///< displayed = stored * displayFactor; by the unit (completed())
  Direction direction = Direction::none;
  std::string window = {};  ///< part of the attempt that is covered: "whole attempt"
  Aggregation aggregation = Aggregation::attempt;
  std::string instruments = {};      ///< how several are joined: "each hand by itself", "union over instruments", ...
  std::string filter = {};           ///< resampling and filter with all their constants, or "none"
  double minCoverage = 0.0;          ///< share of the window that samples must cover for a value; 0: not of samples
  std::vector<Origin> origins = {};  ///< allowed ones
  Finality finality = Finality::running;
  Domain domain = Domain::notNegative;
  std::uint32_t version = 1;      ///< changes whenever a value may change
  std::string definition = {};    ///< the formula in words and symbols, one line
  std::string paperReading = {};  ///< which figure of the paper's Table 2 it answers to and how it reads it; or empty
  /// Reason why a study shows the figure apart and does not test it ("it describes the tracker"); empty: it is an
  /// outcome.
  std::string notOutcome = {};
};

/// Declaration of a script's metric, and the script's identity.
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
