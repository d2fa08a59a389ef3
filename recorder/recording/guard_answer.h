// SPDX-License-Identifier: GPL-3.0-or-later
// What a guarding process sends back: a result or an error, as bytes. Internal to this folder.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "recorder/base/errors.h"

namespace calot::recorder {

/// Runs the task. @return its result or the Error that it threw, packed; where memory was lacking, the Error that
/// `noMemory` makes (of `what`, a file, where nothing more precise is known)
std::string packedAnswer(const std::string& what, const std::function<std::string()>& task,
                         const std::function<Error(const Where&)>& noMemory);

/// What was packed. @return nothing where it was not packed so: a process that a file has broken may send anything
/// @throws Error the one that was packed
std::optional<std::string> unpackedAnswer(const std::string& packed);

}  // namespace calot::recorder
