// SPDX-License-Identifier: GPL-3.0-or-later
// A small scene with vessels and fat, as JSON, and the refusal of a changed one.
#pragma once

#include <cstring>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "recorder/formats/scene_file.h"
#include "tests/support/fault.h"

namespace calot::recorder::test {

inline std::vector<std::byte> bytesOf(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

/// Tetrahedra with a corner at the origin, outward: 50 mm and 20 mm long.
inline const char* const organText = "v 0 0 0\nv 50 0 0\nv 0 50 0\nv 0 0 50\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
inline const char* const fatText = "v 0 0 0\nv 20 0 0\nv 0 20 0\nv 0 0 20\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

inline nlohmann::json sceneWithVessels() {
  return nlohmann::json::parse(R"({
    "format": "calot-scene", "formatVersion": 1, "name": "small", "version": {"major": 1, "minor": 0}, "summary": "A test.",
    "workspace": {"lower": [-0.1, -0.1, -0.1], "upper": [0.1, 0.1, 0.1]},
    "camera": {"position": [0, 0, -0.1], "target": [0, 0, 0], "verticalFieldOfView": 1.2},
    "hands": {
      "left": {"port": [-0.1, 0.1, 0], "home": [-0.02, 0, -0.02], "instrument": "grasper"},
      "right": {"port": [0.1, 0.1, 0], "home": [0.02, 0, -0.02], "instrument": "clip-applier"}
    },
    "organs": [
      {"name": "liver", "appearance": "liver", "mesh": {"file": "organs/a.obj", "unit": "mm"}, "tetrahedra": 100,
       "material": {"youngModulus": 5000, "poissonRatio": 0.45, "density": 1060}, "anchors": []}
    ],
    "vessels": [
      {"name": "trunk", "appearance": "duct", "path": [[-0.05, 0, 0], [-0.04, 0.001, 0], [-0.03, 0, 0]],
       "elements": 20, "radius": 0.003, "wall": 0.001,
       "material": {"youngModulus": 300000, "poissonRatio": 0.4, "density": 1050, "massDamping": 3, "stiffnessDamping": 0.02},
       "ultimateStrain": 0.7, "friction": 0.2, "start": {"kind": "fixed"}, "end": {"kind": "free"}},
      {"name": "branch", "appearance": "duct", "path": [[-0.03, 0, 0], [0, 0, 0]], "radius": 0.002, "wall": 0.0008,
       "material": {"youngModulus": 200000, "poissonRatio": 0.4, "density": 1050},
       "start": {"kind": "vessel", "to": "trunk"}, "end": {"kind": "organ", "to": "liver"}}
    ],
    "fat": [
      {"name": "pad", "appearance": "fat", "mesh": {"file": "organs/f.obj", "unit": "mm"}, "cellSize": 0.001,
       "cellsPerCube": 2, "material": {"youngModulus": 1500, "poissonRatio": 0.3, "density": 910}, "friction": 0.3,
       "attachments": [
         {"to": "liver", "distance": 0.002, "stiffness": 1e8, "damping": 1e6},
         {"to": "branch", "distance": 0.001, "stiffness": 2e8, "damping": 0}]}
    ]
  })");
}

inline LoadedScene load(const nlohmann::json& scene, const std::string& fat = fatText) {
  return sceneFromAssets({{"scenes/small.json", bytesOf(scene.dump())},
                          {"organs/a.obj", bytesOf(organText)},
                          {"organs/f.obj", bytesOf(fat)}});
}

struct Change {
  const char* pointer;
  const char* value;  ///< JSON; empty: the key is taken away
  const char* place;
  std::vector<std::string> values;
};

/// The scene with one value changed is refused.
inline void expectRefused(const Change& change) {
  SCOPED_TRACE(change.pointer);
  nlohmann::json scene = sceneWithVessels();
  const nlohmann::json::json_pointer place(change.pointer);
  if (*change.value == '\0') {
    scene[place.parent_pointer()].erase(place.back());
  } else {
    scene[place] = nlohmann::json::parse(change.value);
  }
  expectFault(ErrorKind::damaged, std::string("scenes/small.json: ") + change.place, change.values,
              [&] { load(scene); });
}

}  // namespace calot::recorder::test
