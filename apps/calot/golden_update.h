// SPDX-License-Identifier: GPL-3.0-or-later
// Making golden recordings anew.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "apps/calot/golden_list.h"

namespace calot::apps {

/// The reason given. @throws Error (invalid) where it says nothing.
const std::string& requiredReason(const std::string& reason);

/// What may stand in the way of an update. @throws Error (invalid): the reason is empty; or all recordings are there
/// and of this build's simulation version; or the work tree that holds `folder` has changes outside of it, or is none.
void refuseUpdate(const std::filesystem::path& folder, const GoldenList& list, const std::string& reason);

/// Runs every recording of the list anew, then replaces files and list together. @param told after each one: the
/// entry before and now. @throws Error with nothing replaced.
void updateGolden(const std::filesystem::path& folder, const GoldenList& list, const std::string& reason,
                  const std::function<void(const GoldenEntry& before, const GoldenEntry& now)>& told);

}  // namespace calot::apps
