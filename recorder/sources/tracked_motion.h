// SPDX-License-Identifier: GPL-3.0-or-later
// Motion of instruments without a scene, as a tracker measured it: what motion checkpoints are computed from
// where nothing was simulated.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "recorder/sources/kinematics_file.h"
#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// One hand's rows.
struct TrackedHand {
  bool present = false;           ///< the file has this hand
  bool oriented = false;          ///< and its orientation
  std::vector<Vec3> position;     ///< p of the tip in the file's frame (m)
  std::vector<Quat> orientation;  ///< unit; z along the shaft towards the tip. Identities where not oriented
};

/// Every row of a file; what is present has as many.
struct TrackedMotion {
  std::string file;          ///< base name
  std::string sha256;        ///< of the file's bytes, hexadecimal: the motion's identity
  std::string device;        ///< class of tracker as declared, or empty
  std::string frame;         ///< as declared, or empty
  double rate = 0.0;         ///< rows a second (Hz); 0: each row has its time
  std::vector<double> time;  ///< of each row since the first (s), increasing
  std::array<TrackedHand, handCount> hand;
};

/// The slave instruments of a kinematics file.
TrackedMotion trackedMotion(const KinematicsMotion& motion);

}  // namespace calot::recorder
