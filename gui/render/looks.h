// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <utility>
#include <vector>

#include "gui/render/draw_list.h"
#include "gui/render/renderer.h"

namespace calot::gui {

/// Looks that a painter has drawn. For the first picture of one a software OpenGL compiles programs, for up to a
/// second.
class LooksDrawn {
 public:
  /// Notes the looks of a picture. @return is one of them new?
  bool note(const DrawList& list, const RenderSettings& settings);

 private:
  std::set<std::pair<Quality, int>> drawn_;
};

/// Parts in every look that an attempt which begins like this may come to: tissue that is charred or parted, clips,
/// blood, every instrument. Each is one triangle of the list. @pre the list has a part
[[nodiscard]] std::vector<DrawPart> looksToCome(const DrawList& list);

}  // namespace calot::gui
