// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/scene/description.h"
#include "sim/scene/model.h"
#include "sim/tissue/tissues.h"

namespace calot::recorder {

/// Kind of operator. Set by the source, not by the caller. Numbers are stored and never reused.
enum class OperatorKind : std::uint8_t { human = 0, kinematics = 1, performer = 2 };
enum class Mode : std::uint8_t { practice = 0, assessment = 1 };

/// Names, as recordings store them. @pre the value is one that has a name
inline constexpr std::array<const char*, 3> operatorKindNames{"human", "kinematics", "performer"};
inline constexpr std::array<const char*, 2> modeNames{"practice", "assessment"};
inline constexpr const char* wordFor(OperatorKind kind) { return operatorKindNames[static_cast<std::size_t>(kind)]; }
inline constexpr const char* wordFor(Mode mode) { return modeNames[static_cast<std::size_t>(mode)]; }

/// Version of the file format (schemas/recording.md) that is written, and the first one that is read.
inline constexpr std::uint32_t formatVersion = 2;
inline constexpr std::uint32_t oldestFormatVersion = 1;

/// A source's description of itself; copied into every recording that it feeds.
struct Provenance {
  OperatorKind kind = OperatorKind::performer;
  std::string profile = {};  ///< performer's profile name, or empty
  std::string profileVersion = {};
  std::string sourceFile = {};    ///< kinematics: base name, never a path
  std::string sourceSha256 = {};  ///< hex, or empty
  std::string device = {};        ///< device class, or empty
  std::string calibration = {};   ///< identifier and date, or empty
};

/// A file that the scene names, byte for byte. The first one is the scene file itself.
struct Asset {
  std::string name;  ///< as the scene names it: "organs/liver.obj"
  std::vector<std::byte> bytes;
};

/// Facts about an attempt supplied by the caller, beyond source and scene.
struct AttemptSettings {
  std::string participant = {};  ///< pseudonym, or empty
  std::string station = {};
  std::string purpose = "training";    ///< "training", "study", "golden", "demo"
  std::string handedness = "unknown";  ///< "right", "left", "unknown"
  Mode mode = Mode::practice;
  std::uint64_t seed = 0;
};

/// Everything that is known when an attempt starts; the recording's root attributes and /scene. Names of tissue in the
/// Model's order: columns of the observables, since the version of StepResult that brought them.
struct AttemptHeader : AttemptSettings, Tissues::Names {
  std::uint32_t formatVersion = recorder::formatVersion;  ///< of the file that it stands in
  std::string attempt;                                    ///< uuid, lower case with hyphens
  std::string parent;                                     ///< uuid of the recording this one branches from, or empty
  std::int64_t forkStep = -1;                             ///< last step shared with the parent; -1: no branch
  std::string startUtc;                                   ///< ISO 8601 with Z
  std::string software;                                   ///< "calot 0.1.0"
  std::string build;                                      ///< compiler, type, revision
  std::uint32_t simulationVersion = 0;
  std::uint32_t stepResultVersion = 0;
  Provenance provenance;
  double tickSeconds = tickLength;
  std::uint32_t ticksPerStep = 10;
  std::string sceneName;
  std::uint32_t sceneMajor = 0, sceneMinor = 0;
  std::vector<Asset> assets;  ///< the scene file first
  DigestLayout layout;
  bool deviceSamples = false;  ///< the recording has a place for a device's raw samples (/device); no attribute

  /// Organs, then vessels, then bodies of fat: what subjects of events and bits of `touching` and `grasping` count.
  [[nodiscard]] std::vector<std::string> structures() const {
    std::vector<std::string> names;
    Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
      if constexpr (Kind::hasStructures) {
        const std::vector<std::string>& own = Kind::namesOf(*this);
        names.insert(names.end(), own.begin(), own.end());
      }
    });
    return names;
  }
};

}  // namespace calot::recorder
