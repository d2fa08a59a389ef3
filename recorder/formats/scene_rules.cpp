// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_rules.h"

#include <algorithm>
#include <stdexcept>

namespace calot::recorder {
namespace {

KeyRule required(const char* key) { return {key, true}; }
KeyRule optional(const char* key) { return {key, false}; }
KeyRule required(const char* key, double lower, double upper) { return {key, true, lower, upper}; }
KeyRule optional(const char* key, double lower, double upper) { return {key, false, lower, upper}; }

KeyRule openBelow(KeyRule rule) {
  rule.lowerOpen = true;
  return rule;
}
KeyRule openAbove(KeyRule rule) {
  rule.upperOpen = true;
  return rule;
}

// A scene is a part of one abdomen: nothing lies farther than this from the origin (m).
constexpr double reach = 1.0;

std::vector<ObjectRule> makeRules() {
  return {
      {"",
       {required("format"),
        required("formatVersion", 1, sceneFormatVersion),
        required("name"),
        required("version"),
        required("summary"),
        required("workspace"),
        required("camera"),
        required("hands"),
        required("organs"),
        optional("connective"),
        optional("vessels"),
        optional("fat"),
        optional("procedure"),
        optional("retraction"),
        optional("clip"),
        optional("cautery"),
        optional("ticksPerStep", 1, 100),
        optional("timeLimit", 0, 86400),
        optional("gravity", -20, 20),
        optional("solver")}},
      {"version", {required("major", 1, 1000000), required("minor", 0, 1000000)}},
      {"workspace", {required("lower", -reach, reach), required("upper", -reach, reach)}},
      {"camera",
       {required("position", -reach, reach), required("target", -reach, reach), optional("up", -1, 1),
        required("verticalFieldOfView", 0.1, 2.6)}},
      {"hands", {required("left"), required("right")}},
      {"hand",
       {required("port", -reach, reach), required("home", -reach, reach), required("instrument"),
        optional("shaftRadius", 0.0005, 0.01), openBelow(optional("couplingStiffness", 0, 100000)),
        openBelow(optional("rollStiffness", 0, 100)), openBelow(optional("largestForce", 0, 100)),
        openBelow(optional("slipForce", 0, 100)), openBelow(optional("tearForce", 0, 100)),
        optional("trocarFriction", 0, 20), optional("wallStiffness", 0, 20), optional("clips", 0, 100)}},
      {"organ",
       {required("name"), required("appearance"), optional("role"), required("mesh"),
        required("tetrahedra", 10, 1000000), required("material"), optional("friction", 0, 2),
        optional("burnThrough", 0, 1000), required("anchors")}},
      {"mesh",
       {required("file"), required("unit"), optional("scale", 0.001, 1000), optional("rotation", -7, 7),
        optional("translation", -reach, reach)}},
      {"material",
       {required("youngModulus", 10, 1e9), openAbove(required("poissonRatio", 0, 0.5)), required("density", 100, 20000),
        optional("massDamping", 0, 1000), optional("stiffnessDamping", 0, 10)}},
      {"anchor", {optional("sphere"), optional("nearOrgan")}},
      {"sphere", {required("centre", -reach, reach), openBelow(required("radius", 0, reach))}},
      {"nearOrgan", {required("organ"), openBelow(required("distance", 0, 0.1))}},
      {"connective",
       {required("name"), optional("role"), required("first"), required("second"),
        openBelow(required("reach", 0, 0.05)), required("strands", 1, 20000), openBelow(optional("stiffness", 0, 1e10)),
        optional("damping", 0, 1e8), openBelow(optional("strength", 0, 1e9)),
        openBelow(optional("fractureEnergy", 0, 1e9)), openBelow(optional("fadeTime", 0, 100))}},
      {"vessel",
       {required("name"), required("appearance"), optional("role"), required("path", -reach, reach),
        optional("elements", 2, 400), required("radius", 0.0002, 0.02), required("wall", 0.00005, 0.02),
        required("material"), openBelow(optional("ultimateStrain", 0, 10)), openBelow(optional("burnThrough", 0, 1000)),
        optional("friction", 0, 2), required("start"), required("end")}},
      {"vesselEnd", {required("kind"), optional("to")}},
      {"fat",
       {required("name"), required("appearance"), optional("role"), required("mesh"),
        required("cellSize", 0.0001, 0.01), optional("cellsPerCube", 1, 8), required("material"),
        optional("friction", 0, 2), required("attachments"), optional("triangle")}},
      {"fatTriangle", {required("corners", -reach, reach), openBelow(required("depth", 0, 0.1))}},
      {"fatAttachment",
       {required("to"), openBelow(required("distance", 0, 0.05)), openBelow(required("stiffness", 0, 1e12)),
        required("damping", 0, 1e10)}},
      {"procedure", {required("specimen"), optional("bed"), optional("fat"), optional("divide"), optional("spare")}},
      {"divide",
       {required("vessel"), optional("patient", 0, 10), optional("specimen", 0, 10), optional("patientAtStart")}},
      {"retraction",
       {required("organ"), required("centre", -reach, reach), openBelow(required("radius", 0, reach)),
        required("displacement", -reach, reach), optional("start", 0, 86400), openBelow(optional("duration", 0, 1000)),
        optional("stage", 0, 1), optional("most", 1, 10), openBelow(optional("stiffness", 0, 100000)),
        optional("damping", 0, 10000)}},
      {"clip",
       {openBelow(optional("width", 0, 0.01)), openBelow(optional("legs", 0, 0.05)), optional("leastGap", 0, 0.1),
        optional("leastJunctionGap", 0, 0.1)}},
      {"cautery",
       {openBelow(optional("power", 0, 1000)), optional("reach", 0, 0.005), optional("carve", 0, 0.005),
        openBelow(optional("spot", 0, 0.0001)), openBelow(optional("charTime", 0, 100)),
        openBelow(optional("recession", 0, 1)), openBelow(optional("coagulationPace", 0, 10)),
        optional("cutChar", 0, 10), optional("sealRadius", 0, 0.01), openBelow(optional("injury", 0, 1))}},
      {"solver",
       {openBelow(optional("tolerance", 0, 0.1)), optional("speedTolerance", 0, 0.001),
        optional("iterations", 1, 100000), openBelow(optional("responseTolerance", 0, 0.1)),
        optional("responseSpeedTolerance", 0, 0.001), openBelow(optional("contactTolerance", 0, 0.001)),
        optional("contactPasses", 1, 100), optional("gapTolerance", 0, 0.001), optional("contactIterations", 1, 100000),
        optional("sleeping")}},
  };
}

}  // namespace

const std::vector<ObjectRule>& sceneRules() {
  static const std::vector<ObjectRule> rules = makeRules();
  return rules;
}

KeyRule sceneCoordinate() { return required("", -reach, reach); }

const ObjectRule& sceneRule(const std::string& definition) {
  const std::vector<ObjectRule>& rules = sceneRules();
  const auto found =
      std::find_if(rules.begin(), rules.end(), [&](const ObjectRule& r) { return r.definition == definition; });
  if (found == rules.end()) throw std::logic_error("no scene rule " + definition);
  return *found;
}

}  // namespace calot::recorder
