// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 3 of a step: contact points of instruments and among organs, and what is awake.
#pragma once

#include <array>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/step/contact_block.h"
#include "sim/step/fat_contacts.h"
#include "sim/step/grasping.h"
#include "sim/step/instrument_clash.h"
#include "sim/step/placed_instrument.h"
#include "sim/step/surfaces.h"
#include "sim/step/tissue_contacts.h"
#include "sim/step/tissue_travel.h"
#include "sim/step/vessel_contacts.h"

namespace calot {

/// Reads: simulated instruments, surfaces, velocities of the tissue. Writes: `contact.blocks` (in the order of hand,
/// structure and contact point; grasps; instruments on each other; tissue on tissue), which bodies are awake, and the
/// overlap of organs as found.
class ContactDetection {
 public:
  /// @param grasping outlives this
  ContactDetection(const Model& model, const Grasping& grasping)
      : model_(model),
        grasping_(grasping),
        tissue_(model),
        travel_(model),
        vessels_(model, travel_),
        fat_(model, travel_) {}

  void invalidate() {
    tissue_.invalidate();
    travel_.invalidate();
    vessels_.invalidate();
    fat_.invalidate();
  }
  void precompute() { tissue_.precompute(); }
  /// @pre surfaces are current
  void run(Surfaces& surfaces, Bodies& bodies, const InstrumentTravels& travels, State& state, Activity& activity,
           ContactSystem& contact, ContactResult& result);

 private:
  void findInstrumentContacts(Surfaces& surfaces, const Bodies& bodies, const InstrumentTravels& travels,
                              const State& state, std::vector<ContactBlock>& blocks);
  void addInstrumentBlock(const Surfaces& surfaces, const State& state, std::size_t hand, std::size_t structure,
                          const SurfaceContact& contact, std::vector<ContactBlock>& blocks) const;

  void findClashes(const InstrumentTravels& travels, std::vector<ContactBlock>& blocks);

  const Model& model_;
  const Grasping& grasping_;
  TissueContacts tissue_;
  TissueTravel travel_;
  VesselContacts vessels_;
  FatContacts fat_;
  std::array<PlacedInstrument, handCount> instrument_;
  std::vector<SurfaceContact> found_;
  std::vector<ClashPoint> clash_;
};

}  // namespace calot
