// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/description.h"

#include <cmath>
#include <type_traits>

#include "sim/instruments/instrument_shape.h"
#include "sim/instruments/instruments.h"
#include "sim/math/record.h"
#include "sim/tissue/structure.h"

namespace calot {

namespace {

FieldWords instrumentWords() {
  FieldWords words;
  for (const InstrumentDefinition* each : instruments())
    words.emplace_back(each->name, static_cast<std::uint32_t>(each->kind));
  return words;
}

}  // namespace

std::vector<Field> HandDescription::fields() {
  using S = HandDescription;
  return {
      object("hand", "One hand's instrument"),
      {"port", at<S, &S::port>, "m", sceneCoordinate, "p_WP, the trocar's pivot, at most 0.3 m off the workspace"},
      {"home", at<S, &S::home>, "m", sceneCoordinate,
       "Tip at the start, in the workspace and at least 0.01 m from the port"},
      {"instrument", at<S, &S::instrument>, instrumentWords(), "Instrument that is mounted (docs/reference/scenes.md)"},
      optional("shaftRadius", at<S, &S::shaftRadius>, "m", within(0.0005, 0.01), "Radius of the shaft"),
      optional("couplingStiffness", at<S, &S::couplingStiffness>, "N/m", above(0, 100000),
               "Stiffness of the virtual coupling at the tip"),
      optional("rollStiffness", at<S, &S::rollStiffness>, "N m/rad", above(0, 100),
               "Stiffness of the virtual coupling about the shaft"),
      optional("largestForce", at<S, &S::maxForce>, "N", above(0, 100),
               "Largest force that the device, and so the virtual coupling, makes"),
      optional("slipForce", at<S, &S::slipForce>, "N", above(0, 100), "Pull at which closed jaws begin to lose tissue"),
      optional("clips", at<S, &S::clips>, "", within(0, 100), "Clips in its clip applier"),
      optional("tearForce", at<S, &S::tearForce>, "N", above(0, 100),
               "Pull at which tissue tears that locked jaws hold"),
      optional("trocarFriction", at<S, &S::trocarFriction>, "N", within(0, 20),
               "Friction of the trocar's seal along the shaft, felt by the hand alone"),
      optional("wallStiffness", at<S, &S::wallStiffness>, "N m/rad", within(0, 20),
               "Resistance of the abdominal wall to tilting the shaft from where it is at the start, felt by the hand "
               "alone"),
  };
}

std::vector<Field> ClipDescription::fields() {
  using S = ClipDescription;
  return {
      object("clip", "Clips, and the distances below which they are too near"),
      optional("width", at<S, &S::width>, "m", above(0, 0.01), "Width along the vessel"),
      optional("legs", at<S, &S::legs>, "m", above(0, 0.05), "Length from the crotch to the tips"),
      optional("leastGap", at<S, &S::minGap>, "m", within(0, 0.1), "Distance between two clips"),
      optional("leastJunctionGap", at<S, &S::minJunctionGap>, "m", within(0, 0.1), "Distance to a junction of vessels"),
  };
}

std::vector<Field> CauteryDescription::fields() {
  using S = CauteryDescription;
  return {
      object("cautery", "Effect of the energised hook on what it touches"),
      optional("power", at<S, &S::power>, "W", above(0, 1000), "Power, all of which goes into the tissue touched"),
      optional("reach", at<S, &S::reach>, "m", within(0, 0.005), "Largest distance of touched tissue from its metal"),
      optional(
          "carve", unstored<double>, "m", within(0, 0.005),
          "No meaning since simulation version 14, where `reach` holds for fat as for all tissue; read for the sake "
          "of older scenes"),
      optional("spot", at<S, &S::spot>, "m^2", above(0, 0.0001),
               "Area that can be touched with the full power on all of it; a larger one shares it"),
      optional("charTime", at<S, &S::charTime>, "s", above(0, 100),
               "Coagulation of a place at full power from which on it counts as charred"),
      optional("recession", at<S, &S::recession>, "m/s", above(0, 1),
               "Speed at which fat recedes from the hook that cuts at full power"),
      optional("coagulationPace", at<S, &S::coagulationPace>, "1", above(0, 10),
               "Speed at which the coagulating current divides tissue, relative to the cutting one"),
      optional("cutChar", at<S, &S::cutChar>, "1", within(0, 10),
               "Char by the cutting current, relative to that by the coagulating one in the same time"),
      optional("sealRadius", at<S, &S::sealRadius>, "m", within(0, 0.01),
               "Largest outer radius of an artery that coagulation seals as it divides it"),
      optional("injury", at<S, &S::injury>, "1", above(0, 1),
               "Share of its burnThrough from which on a vessel's wall counts as injured by heat"),
  };
}

std::vector<Field> DivideDescription::fields() {
  using S = DivideDescription;
  return {
      object("divide", "Vessel to be divided"),
      {"vessel", at<S, &S::vessel>, sceneName, "Name of that vessel"},
      optional("patient", at<S, &S::patient>, "", within(0, 10), "Clips on the side that stays"),
      optional("specimen", at<S, &S::specimen>, "", within(0, 10), "Clips on the side that goes"),
      optional("patientAtStart", at<S, &S::patientAtStart>, "The vessel's start is on the side that stays"),
  };
}

std::vector<Field> ProcedureDescription::fields() {
  using S = ProcedureDescription;
  return {
      object("procedure", "Task of the scene (docs/explanation/procedure.md)"),
      {"specimen", at<S, &S::specimen>, sceneName, "Organ that is to be freed"},
      optional("bed", at<S, &S::bed>, sceneName, "Connective tissue that holds it"),
      optional("fat", at<S, &S::fat>, sceneName, "Fat that hides the vessels"),
      optional("divide", at<S, &S::divide>,
               "Vessels to be clipped and cut; where the first enters the specimen, the bed's lower third begins")
          .items(0, maxStructures),
      optional("spare", at<S, &S::spare>, sceneName, "Vessels that must be neither clipped nor opened")
          .items(0, maxStructures),
  };
}

std::vector<Field> RetractionDescription::fields() {
  using S = RetractionDescription;
  return {
      object("retraction", "An assistant's pull on an organ, by springs on its nodes inside a sphere"),
      {"organ", at<S, &S::organ>, sceneName, "Name of that organ"},
      {"centre", at<S, &S::centre>, "m", sceneCoordinate, "Centre of the sphere, in the reference configuration"},
      {"radius", at<S, &S::radius>, "m", above(0, 1), "Radius of the sphere"},
      {"displacement", at<S, &S::displacement>, "m", sceneCoordinate, "Displacement of the springs' far ends"},
      optional("start", at<S, &S::start>, "s", within(0, 86400), "Time at which the displacement begins"),
      optional("duration", at<S, &S::duration>, "s", above(0, 1000), "Duration of the displacement"),
      optional("stage", at<S, &S::stage>, "1", within(0, 1),
               "Share of the displacement that the trainee may ask for at a time, more or less; 0: none"),
      optional("most", at<S, &S::most>, "1", within(1, 10), "Greatest pull that can be asked for, in displacements"),
      optional("stiffness", at<S, &S::stiffness>, "N/m", above(0, 100000), "Stiffness of all springs together"),
      optional("damping", at<S, &S::damping>, "N s/m", within(0, 10000), "Damping of all springs together"),
  };
}

std::vector<Field> SolverDescription::fields() {
  using S = SolverDescription;
  return {
      object("solver", "Tolerances and caps"),
      optional("tolerance", at<S, &S::tolerance>, "1", above(0, 0.1), "Relative residual of the linear solve"),
      optional(
          "speedTolerance", at<S, &S::speedTolerance>, "m/s", within(0, 0.001),
          "An error whose energy is that of a body at this speed also ends a linear solve; 0: the relative residual "
          "alone does"),
      optional("iterations", at<S, &S::iterations>, "", within(1, 100000), "Cap of its iterations"),
      optional("responseTolerance", at<S, &S::responseTolerance>, "1", above(0, 0.1),
               "Relative residual of the solves that apply changes of contact forces"),
      optional("responseSpeedTolerance", at<S, &S::responseSpeedTolerance>, "m/s", within(0, 0.001),
               "As speedTolerance, for the solves that apply changes of contact forces"),
      optional("contactTolerance", at<S, &S::contactTolerance>, "m", above(0, 0.001),
               "Residual of the contact problem"),
      optional("contactPasses", at<S, &S::contactPasses>, "", within(1, 100),
               "Largest number of times that the contact problem is posed with the gaps that its forces left"),
      optional("gapTolerance", at<S, &S::gapTolerance>, "m", within(0, 0.001), "Gaps that need no further pass"),
      optional("contactIterations", at<S, &S::contactIterations>, "", within(1, 100000),
               "Cap of its sweeps; Newton's method follows where they have not converged"),
      optional("sleeping", at<S, &S::sleeping>, "Untouched organs at rest are not solved"),
  };
}

namespace {

using S = SceneDescription;

std::vector<Field> versionFields() {
  return {
      object("version", "Version of a scene"),
      {"major", at<S, &S::majorVersion>, "", within(1, 1000000),
       "Changes when attempts before and after must not be compared"},
      {"minor", at<S, &S::minorVersion>, "", within(0, 1000000), "Changes with every other change"},
  };
}

std::vector<Field> workspaceFields() {
  return {
      object("workspace", "Axis-aligned box in W; every side at least 0.01 m"),
      {"lower", at<S, &S::workspace, 0>, "m", sceneCoordinate, "Lower corner"},
      {"upper", at<S, &S::workspace, 1>, "m", sceneCoordinate, "Upper corner"},
  };
}

std::vector<Field> handsFields() {
  return {
      object("hands", "The operator's hands"),
      {"left", at<S, &S::hands, 0>, "Left hand"},
      {"right", at<S, &S::hands, 1>, "Right hand"},
  };
}

std::vector<Field> cameraFields() {
  return {
      object("camera", "Endoscope: pinhole camera, x right, y down, z along the view"),
      {"position", at<S, &S::camera, &CameraSample::position>, "m", sceneCoordinate, "p_WC"},
      Field(at<S, &S::camera, &CameraSample::orientation>),
      {"target", unstored<Vec3>, "m", sceneCoordinate, "Point of W in the middle of the picture"},
      optional("up", unstored<Vec3>, "", sceneCoordinate,
               "Direction of W that is up in the picture; [0, 1, 0] if absent"),
      {"verticalFieldOfView", at<S, &S::verticalFieldOfView>, "rad", within(0.1, 2.6),
       "Angle from the picture's top to its bottom"},
  };
}

}  // namespace

std::vector<Field> SceneDescription::fields() {
  std::vector<Field> fields{
      object(
          "",
          "A scene: organs, vessels, fat, the instruments' ports, the endoscope, the workspace. SI units; frame W of "
          "docs/explanation/organs.md. Beyond this schema the loader checks names that are used twice or nowhere, the "
          "camera's directions, homes inside the workspace, and meshes"),
      fileFormat("calot-scene"),
      fileFormatVersion(),
      {"name", at<S, &S::name>, sceneName, "The scene's name; the file is called <name>.json"},
      {"version", keyGroup<S, versionFields>, "Attempts of different major versions are not compared"},
      {"summary", unstored<std::string>, TextRule{500}, "One sentence for people"},
      optional("ticksPerStep", at<S, &S::ticksPerStep>, "", within(1, 100), "Ticks of 1 ms in a simulation step"),
      optional("gravity", at<S, &S::gravity>, "m/s^2", within(-20, 20),
               "Acceleration of gravity in W. The scene is drawn as it is under it: what is held starts in "
               "equilibrium; what nothing holds falls. Zero: nothing has weight"),
      optional("timeLimit", at<S, &S::timeLimit>, "s", within(0, 86400), "Time after which attempts end; 0: never"),
      {"workspace", keyGroup<S, workspaceFields>, "Box in W that the instruments' tips stay in"},
  };
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) { fields.push_back(Kind::sceneKey()); });
  const std::vector<Field> more{
      optional("procedure", at<S, &S::procedure>, "Task"),
      optional("retraction", at<S, &S::retraction>, "Pulls by an assistant").items(0, 8),
      {"hands", keyGroup<S, handsFields>, "Both hands' instruments"},
      {"camera", keyGroup<S, cameraFields>, "The endoscope at the start"},
      optional("clip", at<S, &S::clip>, "Clips"),
      optional("cautery", at<S, &S::cautery>, "The energised hook"),
      optional("solver", at<S, &S::solver>, "Accuracy of a step"),
  };
  fields.insert(fields.end(), more.begin(), more.end());
  return fields;
}

namespace {

/// Least norm of a quaternion that still says a direction. Samples are rounded to 2^-16 (roundedToGrid), so a
/// measurement's is 1 within 1e-4. Smaller would accept noise, larger refuses coarse devices. Assumed.
constexpr double minQuaternionNorm = 0.5;

}  // namespace

bool isMeasurement(const InstrumentSample& sample) {
  return sample.valid && sample.position.allFinite() && sample.orientation.coeffs().allFinite() &&
         std::isfinite(sample.jaw) && sample.orientation.coeffs().norm() > minQuaternionNorm;
}

bool isMeasurement(const CameraSample& sample) {
  const double norm = sample.orientation.coeffs().norm();
  return sample.position.allFinite() && std::isfinite(norm) && norm > minQuaternionNorm;
}

Vec3 clampedToWorkspace(const SceneDescription& scene, const Vec3& tip) {
  return tip.cwiseMax(scene.workspace[0]).cwiseMin(scene.workspace[1]);
}

Vec3 axisOf(const Vec3& port, const Vec3& tip) {
  const Vec3 reach = tip - port;
  const double length = reach.norm();
  return length > 1e-6 ? Vec3(reach / length) : Vec3(0.0, 0.0, -1.0);
}

Pose realPose(const SceneDescription& scene, std::size_t hand, const InstrumentSample& sample,
              const Vec3& previousTip) {
  const Vec3& port = scene.hands[hand].port;
  Quat orientation = sample.orientation;
  orientation.coeffs() /= orientation.coeffs().norm();
  return throughPort(port, clampedToWorkspace(scene, sample.position), orientation, axisOf(port, previousTip));
}

}  // namespace calot
