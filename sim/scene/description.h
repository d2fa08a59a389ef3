// SPDX-License-Identifier: GPL-3.0-or-later
// The scene as plain data: what a scene file says once its assets are read. Everything a Model is built from.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/math/fields.h"
#include "sim/math/linear.h"
#include "sim/scene/samples.h"
#include "sim/tissue/tissues.h"

namespace calot {

/// Port of a hand's instrument, and its virtual coupling.
struct HandDescription {
  Vec3 port = Vec3::Zero();  ///< p_WP, the trocar's pivot (m)
  Vec3 home = Vec3::Zero();  ///< p_WI at the start (m)
  InstrumentKind instrument = InstrumentKind::grasper;
  double shaftRadius = 0.0025;        ///< m
  double couplingStiffness = 1000.0;  ///< of the virtual coupling at the tip (N/m)
  double rollStiffness = 0.2;         ///< of the virtual coupling about the shaft (N m/rad)
  double maxForce = 8.0;              ///< what the device, and so the virtual coupling, can do (N)
  double slipForce = 4.0;             ///< pull at which closed jaws begin to lose tissue (N)
  std::uint32_t clips = 8;            ///< in its clip applier
  double tearForce = 6.0;             ///< pull at which tissue tears that is held faster (locked jaws) (N)
  double trocarFriction = 0.0;        ///< of the trocar's seal on the shaft, felt by the hand alone (N)
  double wallStiffness = 0.0;         ///< of the abdominal wall to tilting the shaft, felt alone (N m/rad)

  static std::vector<Field> fields();
};

/// Clips, and from how near on they are too near.
struct ClipDescription {
  double width = 0.0012;          ///< along the vessel (m)
  double legs = 0.0085;           ///< from the crotch to the tips (m)
  double minGap = 0.001;          ///< between two clips (m)
  double minJunctionGap = 0.002;  ///< to a place where vessels meet (m)

  static std::vector<Field> fields();
};

/// Effect of the energised hook on the tissue that it touches. Times are those at full power: where more than `spot` is
/// touched, the power is shared, and each place gets spot / (all that is touched) of it.
struct CauteryDescription {
  double power = 30.0;             ///< W, all of it taken to go into the tissue touched
  double reach = 0.0003;           ///< farther than this from the hook's metal nothing is touched, of any tissue (m)
  double spot = 8e-6;              ///< area that can be touched with the full power on all of it (m^2)
  double charTime = 0.3;           ///< coagulation of a place from which on it counts as charred (s)
  double recession = 0.05;         ///< speed at which fat recedes from the hook that cuts (m/s)
  double coagulationPace = 0.667;  ///< at which the coagulating current divides tissue, of that of the cutting one
  double cutChar = 0.2;            ///< char by the cutting current, of that by the coagulating one in the same time
  double sealRadius = 0.001;       ///< largest outer radius of an artery that coagulation seals (m)
  double injury = 0.3;             ///< a vessel's wall counts as injured by heat from this share of its burnThrough on

  static std::vector<Field> fields();
};

/// A vessel that is to be clipped and cut, and how many clips should close it on each side of the cut.
struct DivideDescription {
  std::string vessel;
  std::uint32_t patient = 2;   ///< clips on the side that stays
  std::uint32_t specimen = 1;  ///< clips on the side that goes
  bool patientAtStart = true;  ///< the vessel's start is on the side that stays

  static std::vector<Field> fields();
};

/// Task of a scene (docs/explanation/procedure.md). Scenes without a specimen have no task.
struct ProcedureDescription {
  std::string specimen;                   ///< organ that is to be freed
  std::string bed;                        ///< connective tissue that holds it
  std::string fat;                        ///< fat that hides the vessels, or nothing
  std::vector<DivideDescription> divide;  ///< the first ends where the bed's lower third begins
  std::vector<std::string> spare;         ///< vessels that must be neither clipped nor opened

  static std::vector<Field> fields();
};

/// An assistant's pull on an organ, by springs on its nodes inside a sphere.
struct RetractionDescription {
  std::string organ;
  Vec3 centre = Vec3::Zero();        ///< of the sphere, at rest (m)
  double radius = 0.01;              ///< m
  Vec3 displacement = Vec3::Zero();  ///< that the springs' far ends go (m)
  double start = 0.0;                ///< s
  double duration = 2.0;             ///< until they are there (s)
  double stage = 0.0;  ///< that the trainee may ask for, more or less: share of the displacement; 0: cannot be asked
  double most = 1.0;   ///< greatest pull, in displacements, at least 1
  double stiffness = 200.0;  ///< of all springs together (N/m)
  double damping = 2.0;      ///< (N s/m)

  static std::vector<Field> fields();
};

struct SolverDescription {
  double tolerance = 1e-4;          ///< relative residual of the linear solve
  double speedTolerance = 1e-6;     ///< an error whose energy is that of a body at this speed ends a solve, too (m/s)
  std::uint32_t iterations = 200;   ///< cap of the linear solve
  double responseTolerance = 1e-3;  ///< relative residual of the solves that carry out changes of contact forces
  double responseSpeedTolerance = 3e-6;  ///< as speedTolerance, of those (m/s)
  double contactTolerance = 1e-8;        ///< residual of the contact problem (m)
  std::uint32_t contactPasses = 3;       ///< maximum repetitions with the gaps that its forces left
  double gapTolerance = 1e-5;            ///< not any more where these are this small (m)
  std::uint32_t contactIterations = 25;  ///< sweeps, before Newton's method takes over
  bool sleeping = true;                  ///< untouched organs at rest are not solved
  /// Organs give way within their cells, too (sim/step/contact_block.h). No field: scenes cannot do without; tests of
  /// the mesh alone can.
  bool dimples = true;

  static std::vector<Field> fields();
};

struct SceneDescription : Tissues::Descriptions {
  std::string name;
  std::uint32_t majorVersion = 1;  ///< changes when attempts before and after must not be compared
  std::uint32_t minorVersion = 0;
  std::uint32_t ticksPerStep = 10;  ///< a tick is 1 ms
  Vec3 gravity = Vec3::Zero();      ///< m/s^2; the scene is drawn as it is under it (sim/scene/weight_system.h)
  double timeLimit = 0.0;           ///< s; 0: none
  std::array<Vec3, 2> workspace{Vec3::Constant(-0.5), Vec3::Constant(0.5)};  ///< lower and upper corner for tips (m)
  ProcedureDescription procedure;
  std::vector<RetractionDescription> retraction;
  std::array<HandDescription, handCount> hands;
  CameraSample camera;               ///< at the start
  double verticalFieldOfView = 1.0;  ///< rad
  ClipDescription clip;
  CauteryDescription cautery;
  SolverDescription solver;

  static std::vector<Field> fields();
};

inline constexpr double tickLength = 0.001;  ///< s

// Validity of a hand's measurement, and the real pose that it gives, for the step and the haptic tick alike.

/// Valid, finite, and with an orientation that can be normalised.
bool isMeasurement(const InstrumentSample& sample);
bool isMeasurement(const CameraSample& sample);

/// A tip held inside the scene's workspace (m, W).
Vec3 clampedToWorkspace(const SceneDescription& scene, const Vec3& tip);

/// Direction from the port to a tip, unit; straight down where they coincide.
Vec3 axisOf(const Vec3& port, const Vec3& tip);

/// The real instrument of a measurement: orientation normalised, tip held inside the workspace, through the port.
/// @param previousTip gives the axis where the tip is at the port. @pre isMeasurement(sample)
Pose realPose(const SceneDescription& scene, std::size_t hand, const InstrumentSample& sample, const Vec3& previousTip);

}  // namespace calot
