// SPDX-License-Identifier: GPL-3.0-or-later
// A scene looked at as a whole: all faults at once, what catches nothing, and what contact costs.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "recorder/base/errors.h"

namespace calot::recorder {

/// Cost of an organ's surface, as far as its resolution decides.
struct ContactCost {
  std::string organ;
  std::size_t triangles = 0;
  std::size_t tetrahedra = 0;
  double meanEdge = 0.0;  ///< of the surface's triangles (m)
  double cellSize = 0.0;  ///< of the tetrahedra (m)
  /// Triangles whose edges are a third of a cell: finer ones show no more of how the organ deforms.
  std::size_t sensibleTriangles = 0;

  /// Is the surface so fine that preparing and drawing take several times what they need?
  [[nodiscard]] bool isFine() const;
};

struct SceneCheck {
  std::string scene;               ///< its name, or empty
  std::vector<Error> faults;       ///< it cannot be simulated; the tables that depend on faulty ones were not read
  std::vector<std::string> notes;  ///< it can, but probably not as meant: "/organs/0/anchors/1: ..."
  std::vector<ContactCost> costs;  ///< by organ; none where there are faults
};

/// Reads and builds a scene. Anchors and attachments that catch nothing, bodies that nothing holds, and surfaces that
/// are needlessly fine are notes. @throws Error (damaged) only where the file itself cannot be read as JSON
SceneCheck checkScene(const std::filesystem::path& sceneFile);

}  // namespace calot::recorder
