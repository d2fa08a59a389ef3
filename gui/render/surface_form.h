// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "gui/render/mesh.h"

namespace calot::gui {

/// Does every side of every triangle have an opposite side in another triangle? Then the surface bounds a body whose
/// inner side is never visible from outside.
/// @param triangle @pre no negative index
[[nodiscard]] bool isClosed(const std::vector<Index3>& triangle);

/// Data of a surface reused between pictures while its reference shape and triangles stay unchanged.
class SurfaceForm {
 public:
  /// Computes the members below unless they are up to date for this surface.
  void update(const std::vector<Vec3>& rest, const std::vector<Index3>& triangle);

  [[nodiscard]] const std::vector<Vec3>& restNormal() const { return restNormal_; }
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  std::vector<Vec3> rest_, restNormal_;
  std::vector<Index3> triangle_;
  bool closed_ = false;
};

}  // namespace calot::gui
