// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "gui/render/mesh.h"

namespace calot::gui {

/// Is each side of each triangle met by another triangle's, the other way round? Then the surface bounds a body, and
/// its inner side is never seen from outside.
/// @param triangle @pre no negative index
[[nodiscard]] bool isClosed(const std::vector<Index3>& triangle);

/// What a surface keeps from picture to picture as long as its shape at rest and its triangles stay.
class SurfaceForm {
 public:
  /// Works out what is below, unless it is known for this very surface.
  void update(const std::vector<Vec3>& rest, const std::vector<Index3>& triangle);

  [[nodiscard]] const std::vector<Vec3>& restNormal() const { return restNormal_; }
  [[nodiscard]] bool closed() const { return closed_; }

 private:
  std::vector<Vec3> rest_, restNormal_;
  std::vector<Index3> triangle_;
  bool closed_ = false;
};

}  // namespace calot::gui
