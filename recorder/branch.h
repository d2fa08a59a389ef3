// SPDX-License-Identifier: GPL-3.0-or-later
// A branch: the parent's samples up to the fork, then another source. A whole recording of its own, from step 0.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "recorder/engine/session.h"
#include "recorder/loop.h"
#include "recorder/recording/reader.h"
#include "recorder/sources/source.h"

namespace calot::recorder {

/// Is this a recording that can be branched here? @throws Error: refused for a broken chain or one made in assessment
/// mode; undecided (5) for another simulation version.
void refuseParent(const Recording& parent, const ChainVerdict& chain);

/// The last step that a branch shares with its parent: the one that is over at `time`.
/// @param time of the parent's attempt (s) @throws Error (invalid) where that is not a number, before the end of the
/// first step, or beyond the recording's end.
std::uint64_t forkStepAt(const Recording& parent, double time);

/// Header of a branch: the parent's scene, seed and participant, the new source's provenance, practice.
AttemptHeader branchHeader(const Recording& parent, const Model& model, std::uint64_t forkStep,
                           const Provenance& provenance);

/// Re-simulates the parent's steps up to and with the fork step, with the contact sets and lateness that were logged,
/// so that forces and events are the same. Observers of the session receive each.
/// @throws Error (refused) at the first difference from the parent's digests, forces, observables, events or keyframes.
/// @pre the session is new, with the parent's model and seed
void takeParent(Recording& parent, Session& session, std::uint64_t forkStep,
                const std::function<void(std::uint64_t step, std::uint64_t of)>& progress = {});

/// The name that a branch has until the parent's part is taken: TARGET.branch, in the target's folder. Removed with
/// this object unless publish() came before.
class BranchFile {
 public:
  /// @throws Error (invalid) where the target is there and force is not set.
  BranchFile(std::filesystem::path target, bool force);
  ~BranchFile();
  BranchFile(const BranchFile&) = delete;
  BranchFile& operator=(const BranchFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return temporary_; }
  /// Gives the file its name, while it is being written. @throws Error
  void publish();

 private:
  std::filesystem::path target_, temporary_;
  bool force_;
  bool published_ = false;
};

}  // namespace calot::recorder
