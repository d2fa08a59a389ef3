// SPDX-License-Identifier: GPL-3.0-or-later
// Contact sets for the haptic ticks to work on.
#pragma once

#include <cstddef>
#include <optional>

#include "sim/haptics/haptic_tick.h"
#include "sim/scene/model.h"

namespace calot::bench {

/// A set as a step published it, with what its ticks go by.
struct PublishedSet {
  HapticModel model;
  ContactSet set;
  Pose real;  ///< the real instrument in that step
};

/// The right hand's set of the first step of shaftLaidAlongLiver() that has so many places of contact; what is beyond
/// that number is left out. @returns nothing where no step has so many
std::optional<PublishedSet> setOfLaidShaft(std::size_t contacts);

/// Frictional contacts every 2 mm along a shaft on a surface whose places know the less of each other the farther they
/// are apart (4 mm: half), as on an elastic surface; every second one 0.1 mm deep, or all 5 mm. For growth: any number
/// of contacts.
PublishedSet rowOfContacts(std::size_t contacts, bool allDeep = false);

}  // namespace calot::bench
