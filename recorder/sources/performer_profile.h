// SPDX-License-Identifier: GPL-3.0-or-later
// Profiles of performers: strict JSON (schemas/performer.schema.json). They describe motor control, perception and
// decisions, with sources in docs/explanation/sources.md; never a checkpoint's value.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "recorder/base/json_reader.h"
#include "recorder/sources/scope/scope_source.h"

namespace calot::recorder {

struct PerformerProfile {
  std::string name;     ///< "skilled"
  std::string version;  ///< "1.0"
  std::string summary;

  struct Motor {
    double strokeSpeed = 0.0;      ///< mean speed of a free stroke (m/s)
    double contactSpeed = 0.0;     ///< mean speed of a stroke that presses or leaves tissue (m/s)
    double minStroke = 0.0;        ///< s
    double endpointNoise = 0.0;    ///< standard deviation of a stroke's end, per length of the stroke
    double tremorAmplitude = 0.0;  ///< root mean square at the tip, each axis (m)
    double tremorLower = 8.0;      ///< band (Hz)
    double tremorUpper = 12.0;
    double wanderAmplitude = 0.0;  ///< root mean square below 1 Hz, each axis (m)
    double rollSpread = 0.0;       ///< standard deviation of the roll at a target (rad)
    double workSpeed = 0.0;        ///< mean speed of the energised hook in tissue (m/s)
    double overshootShare = 0.0;   ///< of strokes that go too far
    double overshoot = 0.0;        ///< by how much, per length of the stroke

    static std::vector<Field> fields();
  } motor;

  struct Perception {
    double reactionTime = 0.0;    ///< before each correction (s)
    double reactionSpread = 0.0;  ///< its standard deviation (s)
    double lateralError = 0.0;    ///< standard deviation of where a target seems to be, across the view (m)
    double depthError = 0.0;      ///< the same along the view (m)
    double finestError = 0.0;     ///< error on each axis that repeated observation does not reduce (m)

    static std::vector<Field> fields();
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
    bool bimanual = false;          ///< both hands at once; else alternating

    static std::vector<Field> fields();
  } decision;

  /// In scenes in which tissue is to be cleared, divided or freed.
  struct Operation {
    double hesitationShare = 0.0;  ///< share of decisions preceded by a pause
    double hesitation = 0.0;       ///< for so long (s)
    double pedalLag = 0.0;         ///< delay of releasing the pedal after the hook's stroke (s)
    double keepOff = 0.0;          ///< between the hook's metal and a vessel, as meant (m)
    double layer = 0.0;            ///< of fat taken off by one stroke (m)
    double cleared = 0.0;          ///< share of a vessel's length, from 22 % on, that is to be cleared
    double bareShare = 0.0;        ///< of its stations that must be bare before it counts as cleared
    std::uint32_t strokes = 0;     ///< at most, to clear one vessel
    double burnSpeed = 0.0;        ///< mean speed of the energised hook through connective tissue (m/s)
    double pull = 0.0;             ///< of the specimen, by the hand that holds it (m)
    double stretch = 0.0;          ///< length of a strand of the bed that looks too taut, so that it eases off (m)
    double slipShare = 0.0;        ///< of holds that are let go by mistake
    double anticipation = 0.0;     ///< share of the reaction time by which it looks before a stroke is over
    std::uint32_t series = 1;      ///< strokes through fat made by one picture
    std::uint32_t window = 0;      ///< strokes at most, to clear the triangle between the vessels
    double patience = 0.0;         ///< after which the attempt is given up (s)
    std::uint32_t searches = 0;    ///< strokes through fat beside a vessel, before it is found
    double searchSpread = 0.006;   ///< mean distance of those from the vessel's course (m)
    double overrun = 0.024;        ///< of the energised hook in the bed, beyond the last strand (m)
    double plane = 0.5;            ///< where it cuts a strand: 0 at the specimen, 1 at the liver
    double pullOff = 0.06;         ///< share of the bed that the holding hand pulls off at the end

    static std::vector<Field> fields();
  } operation;

  /// Profile of the assistant who holds the endoscope, where it moves (ScopeAssistant).
  ScopeSkill scope;

  static std::vector<Field> fields();
};

/// @throws Error (damaged) naming file and JSON pointer.
PerformerProfile loadPerformer(const std::filesystem::path& file);

/// `performers/<name>.json` under the roots in turn, or a path that ends in ".json".
/// @throws Error (invalid) where there is none, with the names that there are.
std::filesystem::path findPerformer(const std::string& name, const std::vector<std::filesystem::path>& roots);

}  // namespace calot::recorder
