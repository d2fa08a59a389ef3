// SPDX-License-Identifier: GPL-3.0-or-later
// Requests to an engine and its answers, recorded once: proof that a program is the engine that it says it is
// (schemas/engine.md, "Transcripts").
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "recorder/recording/reader.h"

namespace calot::recorder {

/// Requests and answers, each a whole message.
struct Exchange {
  std::vector<std::byte> request, answer;
};
using Transcript = std::vector<Exchange>;

/// Has an engine greet, take a recording's scene, do its first steps with all that a step can come with, go back to a
/// keyframe and on again, and refuse one. @param command starts the engine
/// @throws Error as ChildProcess; (failure) where the engine ends before its time
Transcript makeTranscript(const std::vector<std::string>& command, Recording& recording, std::uint64_t steps);

/// Asks an engine what was asked then. @returns what the first other answer is, or nothing @throws as makeTranscript()
std::string compareWith(const Transcript& transcript, const std::vector<std::string>& command);

std::vector<std::byte> bytesOf(const Transcript& transcript);
/// @throws Error (damaged)
Transcript readTranscript(const std::filesystem::path& file);

}  // namespace calot::recorder
