// SPDX-License-Identifier: GPL-3.0-or-later
// Facts about a scene that checkpoints use: reference sizes, and the structures' roles in the operation.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "recorder/sources/scope/endoscope.h"
#include "sim/scene/description.h"

namespace calot::analytics {

/// Taken from the scene's roles (StructureRole) and sizes, never from names, looks or numbers of structures: so they
/// hold for any scene.
struct SceneFacts {
  struct Organ {
    std::string name;
    StructureRole role = StructureRole::other;
    double skinArea = 0.0;  ///< of its surface at rest (m^2)
    bool hasWall = false;   ///< it can be perforated
  };
  struct Vessel {
    std::string name;
    bool cystic = false;  ///< cystic duct or cystic artery
    bool spared = false;  ///< the procedure says that it must be spared
  };
  struct Connective {
    std::string name;
    bool holdsGallbladder = false;  ///< it is a cystic plate
    double area = 0.0;              ///< of its bed at rest (m^2), where it holds a gallbladder (connective_bed.h)
  };
  /// In the scene's order: the columns of StepResult.
  std::vector<Organ> organ;
  std::vector<Vessel> vessel;
  std::vector<Connective> connective;
  std::size_t fat = 0;               ///< bodies
  bool triangle = false;             ///< a region of fat that is to be cleared is marked
  bool retractionOnRequest = false;  ///< the assistant can be asked to retract more or less
  recorder::PictureFrame picture = {};

  [[nodiscard]] bool hasCystic() const;  ///< there is a cystic vessel
  [[nodiscard]] bool hasSpared() const;  ///< there is a vessel to be spared
};

SceneFacts sceneFacts(const SceneDescription& scene);

}  // namespace calot::analytics
