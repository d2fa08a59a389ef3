// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "gui/render/mesh.h"
#include "sim/scene/scene_view.h"

namespace calot::gui {

/// A closed clip in its own frame (m): two flat legs along y around a gap of three quarters of 2 halfGap (they bite
/// into the wall), joined by a crotch at y = -legs / 2, a little open there as bent wire stays; `width` along z. Wire
/// thickness is half the width.
[[nodiscard]] Mesh makeClip(const ClipView& clip);

}  // namespace calot::gui
