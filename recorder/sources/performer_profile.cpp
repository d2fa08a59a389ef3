// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/performer_profile.h"

#include <fmt/format.h>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/record_json.h"
#include "recorder/base/text_words.h"
#include "sim/math/floating_point.h"

namespace calot::recorder {
namespace fs = std::filesystem;

std::vector<Field> PerformerProfile::Motor::fields() {
  using S = Motor;
  return {
      object("motor", "Motor control of a hand"),
      {"strokeSpeed", at<S, &S::strokeSpeed>, "m/s", within(0.001, 1),
       "Mean speed of a free stroke, whose greatest is 1.875 times that"},
      {"contactSpeed", at<S, &S::contactSpeed>, "m/s", within(0.001, 0.5), "Mean speed of a stroke near tissue"},
      {"shortestStroke", at<S, &S::minStroke>, "s", within(0.05, 5), "Shortest duration of a stroke"},
      {"endpointNoise", at<S, &S::endpointNoise>, "1", within(0, 0.3),
       "Standard deviation of a stroke's end on each axis, per length of the stroke"},
      {"tremorAmplitude", at<S, &S::tremorAmplitude>, "m", within(0, 0.002),
       "Tremor at the tip, root mean square of each axis"},
      {"tremorLower", at<S, &S::tremorLower>, "Hz", within(2, 20), "Lower end of the tremor's band"},
      {"tremorUpper", at<S, &S::tremorUpper>, "Hz", within(2, 20), "Upper end of the tremor's band"},
      {"wanderAmplitude", at<S, &S::wanderAmplitude>, "m", within(0, 0.005),
       "Slow movement (0.1 to 0.8 Hz) at the tip, root mean square of each axis"},
      {"rollSpread", at<S, &S::rollSpread>, "rad", within(0, 1.5), "Standard deviation of the roll at a target"},
      {"workSpeed", at<S, &S::workSpeed>, "m/s", within(0.001, 0.5), "Mean speed of the energised hook in tissue"},
      {"overshootShare", at<S, &S::overshootShare>, "1", within(0, 1), "Share of strokes that go too far"},
      {"overshoot", at<S, &S::overshoot>, "1", within(0, 0.5), "Overshoot, per length of the stroke"},
  };
}

std::vector<Field> PerformerProfile::Perception::fields() {
  using S = Perception;
  return {
      object("perception", "Perception"),
      {"reactionTime", at<S, &S::reactionTime>, "s", within(0, 3),
       "Mean reaction time before each stroke that a look corrects"},
      {"reactionSpread", at<S, &S::reactionSpread>, "s", within(0, 1), "Standard deviation of the reaction time"},
      {"lateralError", at<S, &S::lateralError>, "m", within(0, 0.01),
       "Standard deviation of a target's perceived position across the view"},
      {"depthError", at<S, &S::depthError>, "m", within(0, 0.02),
       "Standard deviation of a target's perceived position along the view"},
      {"finestError", at<S, &S::finestError>, "m", within(0, 0.005),
       "Error on each axis that repeated observation does not reduce"},
  };
}

std::vector<Field> PerformerProfile::Decision::fields() {
  using S = Decision;
  return {
      object("decision", "Decisions in the task"),
      {"touches", at<S, &S::touches>, "", within(1, 50), "Targets for each hand"},
      {"pressDepth", at<S, &S::pressDepth>, "m", within(0, 0.02),
       "Mean depth to which the tip is pressed below the surface in the reference configuration"},
      {"pressSpread", at<S, &S::pressSpread>, "m", within(0, 0.01), "Standard deviation of that depth"},
      {"dwell", at<S, &S::dwell>, "s", within(0, 30), "Time for which the tip stays pressed in"},
      {"pause", at<S, &S::pause>, "s", within(0, 30), "Mean pause before each target"},
      {"pauseSpread", at<S, &S::pauseSpread>, "s", within(0, 10), "Standard deviation of the pause"},
      {"corrections", at<S, &S::corrections>, "", within(0, 10),
       "Further strokes before the press, each after a look that halves the seen error"},
      {"pullBack", at<S, &S::pullBack>, "m", within(0.005, 0.1),
       "Distance from a target, towards the port, at which its approach begins"},
      {"bimanual", at<S, &S::bimanual>, "Both hands at once; otherwise alternating"},
  };
}

std::vector<Field> PerformerProfile::Operation::fields() {
  using S = Operation;
  return {
      object("operation", "Clearing, dividing and freeing of tissue"),
      {"hesitationShare", at<S, &S::hesitationShare>, "1", within(0, 1), "Share of decisions that a pause precedes"},
      {"hesitation", at<S, &S::hesitation>, "s", within(0, 10), "Mean duration of that pause"},
      {"pedalLag", at<S, &S::pedalLag>, "s", within(0, 2),
       "Mean delay of releasing the pedal after the end of the hook's stroke"},
      {"keepOff", at<S, &S::keepOff>, "m", within(0, 0.005), "Intended distance between the hook's metal and a vessel"},
      {"layer", at<S, &S::layer>, "m", within(0.0001, 0.005), "Fat taken off by one stroke"},
      {"cleared", at<S, &S::cleared>, "1", within(0.1, 1),
       "Share of a vessel's length, from 22 % on, that is to be cleared"},
      {"bareShare", at<S, &S::bareShare>, "1", within(0, 1),
       "Share of a vessel's stations that must be bare before it counts as cleared"},
      {"strokes", at<S, &S::strokes>, "", within(0, 200), "Largest number of strokes to clear one vessel"},
      {"burnSpeed", at<S, &S::burnSpeed>, "m/s", within(0.0005, 0.1),
       "Mean speed of the energised hook through connective tissue"},
      {"pull", at<S, &S::pull>, "m", within(0, 0.05), "Pull on the specimen by the hand that holds it"},
      {"stretch", at<S, &S::stretch>, "m", within(0.001, 0.05),
       "Length of a strand of the bed that looks too taut, so that the holding hand eases off"},
      {"slipShare", at<S, &S::slipShare>, "1", within(0, 1), "Share of looks at which the hold is released by mistake"},
      {"anticipation", at<S, &S::anticipation>, "1", within(0, 1),
       "Share of the reaction time by which it looks before a stroke is over"},
      {"series", at<S, &S::series>, "", within(1, 20), "Strokes through fat made by one picture"},
      {"window", at<S, &S::window>, "", within(0, 200),
       "Largest number of strokes to clear the triangle between the vessels"},
      {"patience", at<S, &S::patience>, "s", within(10, 3600), "Time after which the attempt is given up"},
      optional("searches", at<S, &S::searches>, "", within(0, 50),
               "Strokes through fat beside a vessel's course, before the vessel is found"),
      optional("searchSpread", at<S, &S::searchSpread>, "m", within(0, 0.02),
               "Mean distance of those strokes from the vessel's course"),
      optional("overrun", at<S, &S::overrun>, "m", within(0, 0.024),
               "Way of the energised hook in the bed beyond the last strand that it is to cut"),
      optional("plane", at<S, &S::plane>, "1", within(0.2, 0.8),
               "Where the hook cuts a strand of the bed: 0 at the specimen, 1 at the liver"),
      optional("pullOff", at<S, &S::pullOff>, "1", within(0, 0.5),
               "Share of the bed that the holding hand pulls off at the end"),
  };
}

std::vector<Field> ScopeSkill::fields() {
  using S = ScopeSkill;
  return {
      object("scope", "The assistant who holds the endoscope, where it moves"),
      {"reaction", at<S, &S::reaction>, "s", within(0.05, 5), "Time from one look at the picture to the next"},
      {"deadZone", at<S, &S::deadZone>, "1", within(0, 1),
       "Distance that the work may leave the picture's centre, in halves of the picture's height"},
      {"horizonError", at<S, &S::horizonError>, "rad", within(0, 0.5),
       "Root mean square of the camera head's rotation from level"},
  };
}

std::vector<Field> PerformerProfile::fields() {
  using S = PerformerProfile;
  return {
      object(
          "",
          "Profile of a synthetic operator: motor control, perception, decisions. It never holds a checkpoint's value"),
      fileFormat("calot-performer"),
      fileFormatVersion(),
      {"name", at<S, &S::name>, TextRule{64}, "The profile's name; logged in every recording"},
      {"version", at<S, &S::version>, TextRule{32}, "Changes with every change of a value; logged in every recording"},
      {"summary", at<S, &S::summary>, TextRule{500}, "One sentence for people"},
      {"motor", at<S, &S::motor>, "Motor control of a hand"},
      {"perception", at<S, &S::perception>, "Perception"},
      {"decision", at<S, &S::decision>, "Decisions in the task"},
      {"operation", at<S, &S::operation>, "Clearing, dividing and freeing of tissue"},
      optional("scope", at<S, &S::scope>, "The assistant who holds the endoscope, where it moves"),
  };
}

PerformerProfile loadPerformer(const fs::path& file) {
  const FloatingPointScope environment;
  const std::string name = file.filename().string();
  const nlohmann::json json = parseStrictJson(readFileBytes(file, name, std::size_t{4} << 20U), name);
  const JsonPlace root(json, name);
  PerformerProfile profile;
  readRecord(root, profile);
  if (profile.motor.tremorUpper < profile.motor.tremorLower)
    root.at("motor").at("tremorUpper").fail("below \"tremorLower\"");
  return profile;
}

fs::path findPerformer(const std::string& name, const std::vector<fs::path>& roots) {
  return findJsonFile(name, roots, "performers", "performer", "profile");
}

}  // namespace calot::recorder
