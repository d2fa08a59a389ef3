// SPDX-License-Identifier: GPL-3.0-or-later
// Damage that more than one stage does: organs opened, vessels parted. Internal to this folder.
#pragma once

#include "sim/step/bodies.h"
#include "sim/step/step_log.h"
#include "sim/step/surfaces.h"
#include "sim/vessel/beam_state.h"

namespace calot {

/// Opens an organ that has a wall to be opened, once. @param exposure cautery there (s); 0: torn
void perforateOrgan(const Model& model, std::size_t organ, const Vec3& where, double exposure, State& state,
                    Activity& activity, StepLog& log);

/// Parts a vessel; reports it, what that leaves open, and the clips on either side of a cut.
/// @param kind vesselCut or vesselBurned
void partVessel(const Model& model, std::size_t structure, const BeamPoint& where, EventKind kind, std::size_t hand,
                Bodies& bodies, Surfaces& surfaces, State& state, Activity& activity, StepLog& log);

/// Reports what a vessel that tore in this step leaves open. @param element that tore
void reportTear(const Model& model, std::size_t tree, std::size_t element, State& state, StepLog& log);

}  // namespace calot
