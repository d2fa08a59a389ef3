// SPDX-License-Identifier: GPL-3.0-or-later
// Takes an instrument out of tissue that it still stands in. Internal to this folder.
#pragma once

#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/instruments/port.h"
#include "sim/step/instrument_clash.h"
#include "sim/step/surfaces.h"

namespace calot {

/// Rows of the contact problem are linear, tissue is not: what an instrument still penetrates after the step, it leaves
/// by the shortest motion of its own. In a fold the nearest surface may lie deeper in: then it goes back along its
/// shaft, the way it came in, and looks again. Where tissue presses from two sides there may be no way out: that depth
/// is reported as pinched.
class PenetrationResolver {
 public:
  explicit PenetrationResolver(const Model& model) : model_(model) {}

  /// Writes the hand's simulated pose; raises `contact.maxDepth` or `pinchedDepth` to what is left (m).
  /// @pre surfaces are current
  void run(Surfaces& surfaces, std::size_t hand, State& state, ContactResult& contact);

 private:
  /// A point at which an instrument stands inside a structure or the other instrument.
  struct Inside {
    ToolRow row;
    Vec3 normal;
    double gap;
  };
  /// Result of a search.
  struct Outcome {
    Pose pose;
    double depth;  ///< that is left (m)
    bool pinched;  ///< between tissue on two sides
  };

  double findInside(Surfaces& surfaces, const State& state, std::size_t hand, const Pose& pose);
  [[nodiscard]] ToolRow minWayOut() const;
  Outcome search(Surfaces& surfaces, const State& state, std::size_t hand, Pose pose);

  const Model& model_;
  PlacedInstrument instrument_, other_;
  std::vector<ClashPoint> clash_;
  std::vector<SurfaceContact> found_;
  std::vector<Inside> inside_;
};

/// Counts the gaps of contacts from index `from` on from `allowed` deeper, and drops those that are then `far` or
/// wider.
void allowDepth(double allowed, double far, std::size_t from, std::vector<SurfaceContact>& contacts);

}  // namespace calot
