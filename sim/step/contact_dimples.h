// SPDX-License-Identifier: GPL-3.0-or-later
// The dimple under an instrument that presses on an organ, which the mesh is too coarse to resolve. Internal to this
// folder.
//
// A force on a mesh of cells of size h acts as if it were spread over a patch of size e: the mesh is stiffer to an
// instrument than tissue is, the more so the coarser it is. What is missing is known of the half-space that tissue is
// near the surface (sim/contact/sphere_indentation.h). It gives way along its smooth normal N, of which the rows'
// normals n_i have the shares p_i = n_i . N. Normal rows i of a hand on an organ, with forces l at the places x of the
// skin, open by
//   p_i u_i(l),  u_i = sum_j K_ij p_j l_j + g(F),
//   K_ij = k(|x_i - x_j|; s) - k(|x_i - x_j|; e),  F = sum of p_j l_j over the rows of one capsule of the instrument,
// k the Green's function of a load that is spread (by the instrument, s; by the mesh, e), and g by how much deeper a
// round end sinks in than a flat one. So the rows of a capsule share one dimple, however many the mesh makes, and
// capsules side by side press on each other's.
//
// Tissue is viscous: u + beta du/dt takes the place of u, beta the organ's stiffness damping, as in its mesh. By
// implicit Euler, u = w u(l) + (1 - w) u_before with w = h / (h + beta), which dissipates at any step. u_before is
// State.
#pragma once

#include "sim/step/contact_block.h"
#include "sim/step/surfaces.h"

namespace calot {

/// Depth by which a structure's skin gives way to a hand's capsule beyond what the mesh resolves (m): detection takes
/// the capsule as much farther out.
Vec3 dimpleOf(const HandState& hand, std::size_t structure, std::size_t piece);

/// Size of the patch over which an organ's mesh spreads a force that its nodes take, as seen from a place on its skin
/// (m).
double meshSpread(const OrganModel& organ, const SolidSolver::Impulse& place, const SolidSolver::Impulse& force);

/// Collects the dimples of the blocks and what does not change within a step: `contact.dimples`,
/// `contact.sharedDimple`.
/// @pre rows are numbered
void findDimples(const Model& model, const State& state, double step, ContactSystem& contact);

/// By how much the dimples open the rows' gaps under these forces, and the derivative of that: `contact.dimpleGap`,
/// `contact.dimpleCompliance`. @pre findDimples()
void evaluateDimples(std::span<const double> lambda, ContactSystem& contact);

/// The same without the derivative.
void evaluateDimpleGaps(std::span<const double> lambda, ContactSystem& contact);

/// Keeps the dimples for the next step; those that nothing presses fade. @pre `contact.dimpleGap` is that of
/// `contact.lambda`
void storeDimples(const Model& model, double step, const ContactSystem& contact, State& state);

}  // namespace calot
