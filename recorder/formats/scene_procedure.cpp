// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/scene_procedure.h"

#include <algorithm>
#include <string>

#include "recorder/formats/scene_names.h"
#include "recorder/formats/scene_rules.h"

namespace calot::recorder {

namespace {

constexpr std::size_t maxVessels = 16;
constexpr std::size_t maxRetractions = 8;

template <class Named>
bool knows(const std::vector<Named>& all, const std::string& name) {
  return std::any_of(all.begin(), all.end(), [&](const Named& one) { return one.name == name; });
}

template <class Named>
std::string readKnown(const JsonObject& object, const std::string& key, const std::vector<Named>& all,
                      const std::string& what) {
  std::string name = readName(object, key);
  if (!knows(all, name)) object.at(key).fail("the scene has no " + what + " of this name");
  return name;
}

}  // namespace

ProcedureDescription readProcedure(const JsonPlace& place, const SceneDescription& scene) {
  const JsonObject object = place.object(sceneRule("procedure"));
  ProcedureDescription procedure;
  procedure.specimen = readKnown(object, "specimen", scene.organs, "organ");
  if (object.has("bed")) {
    procedure.bed = readKnown(object, "bed", scene.connective, "connective tissue");
    const auto bed = std::find_if(scene.connective.begin(), scene.connective.end(),
                                  [&](const ConnectiveDescription& c) { return c.name == procedure.bed; });
    if (bed->first != procedure.specimen && bed->second != procedure.specimen) {
      object.at("bed").fail("does not hold the specimen");
    }
  }
  if (object.has("fat")) procedure.fat = readKnown(object, "fat", scene.fat, "fat");
  if (object.has("divide")) {
    for (const JsonPlace& item : object.at("divide").list(0, maxVessels)) {
      const JsonObject one = item.object(sceneRule("divide"));
      DivideDescription divide;
      divide.vessel = readKnown(one, "vessel", scene.vessels, "vessel");
      const bool twice = std::any_of(procedure.divide.begin(), procedure.divide.end(),
                                     [&](const DivideDescription& other) { return other.vessel == divide.vessel; });
      if (twice) one.at("vessel").fail("is named a second time");
      one.read("patient", divide.patient);
      one.read("specimen", divide.specimen);
      one.read("patientAtStart", divide.patientAtStart);
      procedure.divide.push_back(divide);
    }
  }
  if (object.has("spare")) {
    for (const JsonPlace& item : object.at("spare").list(0, maxVessels)) {
      const std::string name = item.text(maxSceneName);
      if (!knows(scene.vessels, name)) item.fail("the scene has no vessel of this name");
      const bool divided = std::any_of(procedure.divide.begin(), procedure.divide.end(),
                                       [&](const DivideDescription& d) { return d.vessel == name; });
      if (divided) item.fail("this vessel is to be divided");
      procedure.spare.push_back(name);
    }
  }
  return procedure;
}

std::vector<RetractionDescription> readRetractions(const JsonPlace& place,
                                                   const std::vector<OrganDescription>& organs) {
  std::vector<RetractionDescription> all;
  for (const JsonPlace& item : place.list(0, maxRetractions)) {
    const JsonObject object = item.object(sceneRule("retraction"));
    RetractionDescription retraction;
    retraction.organ = readKnown(object, "organ", organs, "organ");
    object.read("centre", retraction.centre);
    object.read("radius", retraction.radius);
    object.read("displacement", retraction.displacement);
    object.read("start", retraction.start);
    object.read("duration", retraction.duration);
    object.read("stage", retraction.stage);
    object.read("most", retraction.most);
    object.read("stiffness", retraction.stiffness);
    object.read("damping", retraction.damping);
    all.push_back(retraction);
  }
  return all;
}

ClipDescription readClip(const JsonPlace& place) {
  const JsonObject object = place.object(sceneRule("clip"));
  ClipDescription clip;
  object.read("width", clip.width);
  object.read("legs", clip.legs);
  object.read("leastGap", clip.minGap);
  object.read("leastJunctionGap", clip.minJunctionGap);
  return clip;
}

CauteryDescription readCautery(const JsonPlace& place) {
  const JsonObject object = place.object(sceneRule("cautery"));
  CauteryDescription cautery;
  object.read("power", cautery.power);
  object.read("reach", cautery.reach);
  object.read("spot", cautery.spot);
  object.read("charTime", cautery.charTime);
  object.read("recession", cautery.recession);
  object.read("coagulationPace", cautery.coagulationPace);
  object.read("cutChar", cautery.cutChar);
  object.read("sealRadius", cautery.sealRadius);
  object.read("injury", cautery.injury);
  return cautery;
}

}  // namespace calot::recorder
