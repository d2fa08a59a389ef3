// SPDX-License-Identifier: GPL-3.0-or-later
// Stage 3 of a step: contact points of instruments and among organs, and the bodies that are awake.
#pragma once

#include <array>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/step/body.h"
#include "sim/step/contact_block.h"
#include "sim/step/fat_contacts.h"
#include "sim/step/grasping.h"
#include "sim/step/instrument_clash.h"
#include "sim/step/surfaces.h"
#include "sim/step/tissue_contacts.h"
#include "sim/step/tissue_travel.h"
#include "sim/step/vessel_contacts.h"
#include "sim/tissue/organ/organ_tissue.h"

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

// The patch of an organ's skin that takes the force of an instrument's capsule. Internal to this folder.
//
// A force on the corners of one triangle pulls a node down by more than its cell where cells are as small as the tip,
// and into a cone where they are larger: neither is linear any more. So a part of the force goes to a ring of points
// about the contact point. How the skin gives way under such a load follows from the nodes' weights (meshSpread()); the
// dimple is what a round end sinks in beyond that.

/// The skin's normal at a place in a triangle, as it varies between those at the corners (Phong 1975); zero where these
/// cancel.
Vec3 smoothNormal(const ContactSurface& mesh, const std::vector<Vec3>& points, const std::array<int, 3>& node,
                  const Vec3& weight);

/// Nodes that take the force of a capsule on a triangle of an organ's skin. Depends on the place alone, not on how the
/// skin is deformed. @param weight barycentric coordinates @param radius of the capsule (m)
SolidSolver::Impulse pressedPatch(const OrganModel& organ, const Skin& skin, const std::array<int, 3>& node,
                                  const Vec3& weight, double radius);

}  // namespace calot
