// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "sim/contact/surface_patches.h"
#include "sim/scene/description.h"

namespace calot::test {

/// A surface as it is described, and as contact takes it.
struct Body {
  SurfaceDescription skin;
  ContactSurface surface;
  explicit Body(SurfaceDescription s) : skin(std::move(s)), surface(skin.vertex, skin.triangle) {}
};

}  // namespace calot::test
