// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles of performers: strict JSON (schemas/performer.schema.json). They hold how a hand moves, what an eye sees and
// how a task is decided, with sources in docs/sources.md; never a checkpoint's value.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "recorder/formats/json_reader.h"

namespace calot::recorder {

struct PerformerProfile {
  std::string name;     ///< "skilled"
  std::string version;  ///< "1.0"
  std::string summary;

  struct Motor {
    double strokeSpeed = 0.0;      ///< mean speed of a free stroke (m/s)
    double contactSpeed = 0.0;     ///< mean speed of a stroke that presses or leaves tissue (m/s)
    double shortestStroke = 0.0;   ///< s
    double endpointNoise = 0.0;    ///< standard deviation of a stroke's end, per length of the stroke
    double tremorAmplitude = 0.0;  ///< root mean square at the tip, each axis (m)
    double tremorLower = 8.0;      ///< band (Hz)
    double tremorUpper = 12.0;
    double wanderAmplitude = 0.0;  ///< root mean square below 1 Hz, each axis (m)
    double rollSpread = 0.0;       ///< standard deviation of the roll at a target (rad)
  } motor;

  struct Perception {
    double reactionTime = 0.0;    ///< before each correction (s)
    double reactionSpread = 0.0;  ///< its standard deviation (s)
    double lateralError = 0.0;    ///< standard deviation of where a target seems to be, across the view (m)
    double depthError = 0.0;      ///< the same along the view (m)
  } perception;

  struct Decision {
    std::uint32_t touches = 0;      ///< targets for each hand
    double pressDepth = 0.0;        ///< how far the tip is pressed in (m)
    double pressSpread = 0.0;       ///< its standard deviation (m)
    double dwell = 0.0;             ///< pressed in (s)
    double pause = 0.0;             ///< between targets (s)
    double pauseSpread = 0.0;       ///< its standard deviation (s)
    std::uint32_t corrections = 0;  ///< further strokes that bring the tip onto a target
    double pullBack = 0.0;          ///< towards the port between targets (m)
    bool bimanual = false;          ///< both hands at once; else in turns
  } decision;
};

const std::vector<ObjectRule>& performerRules();

/// @throws Error (damaged) naming file and JSON pointer.
PerformerProfile loadPerformer(const std::filesystem::path& file);

/// `performers/<name>.json` under the roots in turn, or a path that ends in ".json".
/// @throws Error (usage) where there is none, with the names that there are.
std::filesystem::path findPerformer(const std::string& name, const std::vector<std::filesystem::path>& roots);

}  // namespace calot::recorder
