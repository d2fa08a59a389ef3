// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/math/linear.h"

namespace calot::recorder {

/// Rotation of a plane from the images of its two axes: its first columns are the orthonormal pair closest to both
/// (least squares), M (M^T M)^(-1/2) of M = [across up], the third is their cross product. Not finite where they are
/// parallel.
Mat3 planeRotation(const Vec3& across, const Vec3& up);

}  // namespace calot::recorder
