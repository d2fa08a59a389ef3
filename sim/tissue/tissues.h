// SPDX-License-Identifier: GPL-3.0-or-later
// The kinds of tissue. What description, Model, State, StepResult, scene view, digests and the recording's layout know
// of organs, connective tissue, vessels and fat, they know through this list alone: a further kind takes a folder
// beside these four and a line here.
//
// A kind is a struct with
//   Descriptions, Models, States, Results, Names   what it adds to SceneDescription, Model, State, StepResult, and to
//                                                  the names that a recording stores: plain structs, inherited by those
//   Result              what a step reports of one of them, with its list of fields (sim/math/record.h)
//   results             the group of the recording that holds them
//   sceneKey()          its list in SceneDescription, as a field of scene files (sim/math/record.h)
//   componentPrefix     of its digests' names
//   hasStructures       whether it can be touched
//   components()        calls visit(prefix, index, part) for each component of State
//   resultsOf(), namesOf()  its list in Results and Names (without structures there are no Names)
//   build()             adds it to a Model, after the kinds before it; returns what is wrong, or nothing
//   listStructures()    what of it can be touched
//   bodies()            how many linear systems it is solved as
//   nameOf()            of the i-th of its components
//   start(), fits()     of its part of State: the state before the first step; whether bytes from outside could be a
//                       State of this model
//   resize()            of its part of StepResult
//   makeViewer()        its surfaces in a scene view
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "sim/tissue/connective/connective_kind.h"
#include "sim/tissue/fat/fat_tissue.h"
#include "sim/tissue/organ/organ_tissue.h"
#include "sim/tissue/vessel/vessel_tissue.h"

namespace calot {

template <class... Kind>
struct TissueList {
  static constexpr std::size_t count = sizeof...(Kind);

  struct Descriptions : Kind::Descriptions... {};
  struct Models : Kind::Models... {};
  struct States : Kind::States... {};
  struct Results : Kind::Results... {};
  struct Names : Kind::Names... {};

  /// Calls visit(std::type_identity<K>{}, i) for each kind K, the i-th of the list.
  template <class Visit>
  static void forEach(Visit&& visit) {
    TissueId id = 0;
    (visit(std::type_identity<Kind>{}, id++), ...);
  }

  /// Index of a kind in the list.
  template <class Wanted>
  static constexpr TissueId idOf() {
    TissueId id = 0;
    TissueId found = 0;
    ((std::is_same_v<Wanted, Kind> ? void(found = id++) : void(++id)), ...);
    return found;
  }
};

/// Order: of components in a State's digest, of structures, of groups in a recording. A kind may refer to those before
/// it when it is built.
using Tissues = TissueList<OrganTissue, ConnectiveKind, VesselTissue, FatTissue>;

template <class Kind>
inline constexpr TissueId tissueId = Tissues::idOf<Kind>();

}  // namespace calot
