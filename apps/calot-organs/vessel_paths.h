// SPDX-License-Identifier: GPL-3.0-or-later
// Ducts and arteries around Calot's triangle, in W: the points that their centre lines pass. Scenes hold them as
// `path` (a test compares), and the fat is shaped around them. Sizes and their sources stand in
// docs/explanation/organs.md.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "sim/vessel/beam_model.h"

namespace calot::organs {

struct VesselPath {
  std::string name;
  double radius = 0.0;      ///< outer (m)
  double wall = 0.0;        ///< thickness (m)
  std::vector<Vec3> point;  ///< from start to end (m)
};

/// Elements of each vessel in the scenes: where a vessel can grow out of another.
inline constexpr std::size_t vesselElements = 40;

inline Vec3 toMicrometre(const Vec3& p) {
  return {std::round(p[0] * 1e6) / 1e6 + 0.0, std::round(p[1] * 1e6) / 1e6 + 0.0, std::round(p[2] * 1e6) / 1e6 + 0.0};
}

/// Bile duct from behind the duodenum up to the junction; hepatic duct from there to the porta; cystic duct from there
/// to the gallbladder's neck; right hepatic artery behind the hepatic duct and up to the porta; cystic artery from it,
/// across Calot's triangle, to the neck.
inline std::vector<VesselPath> vesselPaths() {
  const Vec3 junction(-0.0480, -0.0430, -0.0320);
  std::vector<VesselPath> vessels{
      {"bile-duct",
       0.0030,
       0.0010,
       {{-0.0445, -0.0560, -0.0830}, {-0.0475, -0.0510, -0.0660}, {-0.0490, -0.0465, -0.0485}, junction}},
      {"hepatic-duct",
       0.0030,
       0.0010,
       {junction,
        {-0.0462, -0.0425, -0.0160},
        {-0.0436, -0.0420, 0.0020},
        {-0.0400, -0.0410, 0.0200},
        {-0.0335, -0.0395, 0.0500}}},
      {"cystic-duct",
       0.0020,
       0.0008,
       {junction,
        {-0.0415, -0.0412, -0.0300},
        {-0.0355, -0.0372, -0.0295},
        {-0.0302, -0.0330, -0.0288},
        {-0.0266, -0.0312, -0.0256},
        {-0.0245, -0.0303, -0.0222}}},
      {"right-hepatic-artery",
       0.0017,
       0.0005,
       {{-0.0680, -0.0500, -0.0330},
        {-0.0570, -0.0520, -0.0240},
        {-0.0465, -0.0505, -0.0150},
        {-0.0375, -0.0460, -0.0070},
        {-0.0310, -0.0420, 0.0050},
        {-0.0260, -0.0390, 0.0220},
        {-0.0215, -0.0365, 0.0460}}}};
  const Vec3 branching = toMicrometre(evenNodes(vessels.back().point, vesselElements)[17]);
  vessels.push_back({"cystic-artery",
                     0.0009,
                     0.0003,
                     {branching,
                      {-0.0335, -0.0415, -0.0105},
                      {-0.0285, -0.0378, -0.0130},
                      {-0.0225, -0.0338, -0.0122},
                      {-0.0165, -0.0298, -0.0098}}});
  return vessels;
}

}  // namespace calot::organs
