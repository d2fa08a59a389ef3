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
#include "sim/scene/structure_role.h"

namespace calot {

/// Closed triangle surface of an organ in W at rest (m).
struct SurfaceDescription {
  std::vector<Vec3> vertex;
  std::vector<Index3> triangle;  ///< outward

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("vertex", self.vertex);
    visit("triangle", self.triangle);
  }
};

/// Isotropic material of a co-rotational solid.
struct MaterialDescription {
  double youngModulus = 5000.0;    ///< Pa
  double poissonRatio = 0.45;      ///< in [0, 0.5)
  double density = 1060.0;         ///< kg/m^3
  double massDamping = 0.0;        ///< Rayleigh alpha (1/s)
  double stiffnessDamping = 0.01;  ///< Rayleigh beta (s)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("youngModulus", self.youngModulus);
    visit("poissonRatio", self.poissonRatio);
    visit("density", self.density);
    visit("massDamping", self.massDamping);
    visit("stiffnessDamping", self.stiffnessDamping);
  }
};

/// Region of an organ whose nodes are held at their rest position: all nodes inside the sphere, or (when `nearOrgan` is
/// not empty) all nodes within `distance` of that organ's rest surface.
struct AnchorDescription {
  Vec3 centre = Vec3::Zero();  ///< m
  double radius = 0.0;         ///< m
  std::string nearOrgan;
  double distance = 0.0;  ///< m

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("centre", self.centre);
    visit("radius", self.radius);
    visit("nearOrgan", self.nearOrgan);
    visit("distance", self.distance);
  }
};

struct OrganDescription {
  std::string name;
  std::string appearance;
  StructureRole role = StructureRole::other;
  SurfaceDescription surface;
  std::uint32_t tetrahedra = 0;  ///< requested number
  MaterialDescription material;
  double friction = 0.1;     ///< Coulomb coefficient of an instrument on this organ
  double burnThrough = 0.0;  ///< cautery at one spot that perforates its wall (s); 0: it has none
  std::vector<AnchorDescription> anchors;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("name", self.name);
    visit("appearance", self.appearance);
    visit("role", self.role);
    visit("surface", self.surface);
    visit("tetrahedra", self.tetrahedra);
    visit("material", self.material);
    visit("friction", self.friction);
    visit("burnThrough", self.burnThrough);
    visit("anchors", self.anchors);
  }
};

/// Connective tissue over the bed where one organ lies on another (sim/connective/connective_bed.h).
struct ConnectiveDescription {
  std::string name;
  StructureRole role = StructureRole::other;
  std::string first;            ///< organ whose surface the bed is part of
  std::string second;           ///< organ that it lies on
  double reach = 0.004;         ///< triangles of the first organ no farther from the second are the bed (m)
  std::uint32_t strands = 200;  ///< at least so many
  double stiffness = 2e5;       ///< of a unit area of bed (N/m^3)
  double damping = 2e3;         ///< (N s/m^3)
  double strength = 4e3;        ///< pull per area at which it tears (Pa)
  double fadeTime = 0.4;        ///< in which the energised hook burns a strand through (s)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("name", self.name);
    visit("role", self.role);
    visit("first", self.first);
    visit("second", self.second);
    visit("reach", self.reach);
    visit("strands", self.strands);
    visit("stiffness", self.stiffness);
    visit("damping", self.damping);
    visit("strength", self.strength);
    visit("fadeTime", self.fadeTime);
  }
};

/// How an end of a vessel is held.
struct VesselEndDescription {
  enum class Kind : std::uint8_t {
    free,   ///< not at all
    fixed,  ///< at its place at rest
    organ,  ///< grown to an organ: goes where the tissue there goes
    vessel  ///< grows out of an earlier vessel, at its node nearest to the end; starts only
  };
  Kind kind = Kind::free;
  std::string to;            ///< name of that organ or vessel
  double stiffness = 200.0;  ///< of all springs of an end that is grown to an organ together (N/m); not in scene files
  double damping = 0.0;      ///< the same (N s/m)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("kind", self.kind);
    visit("to", self.to);
    visit("stiffness", self.stiffness);
    visit("damping", self.damping);
  }
};

/// A duct or an artery: a tube along a curve (sim/vessel/beam_model.h).
struct VesselDescription {
  std::string name;
  std::string appearance;
  StructureRole role = StructureRole::other;
  std::vector<Vec3> path;        ///< points that the centre line passes at rest, from start to end, in W (m)
  std::uint32_t elements = 40;   ///< of equal length
  double radius = 0.0015;        ///< outer (m)
  double wall = 0.0005;          ///< thickness (m)
  MaterialDescription material;  ///< of the wall
  double ultimateStrain = 0.6;   ///< stretch at which it tears
  double burnThrough = 1.0;      ///< cautery at one spot that parts it (s)
  double friction = 0.1;         ///< Coulomb coefficient of an instrument on it
  VesselEndDescription start, end;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("name", self.name);
    visit("appearance", self.appearance);
    visit("role", self.role);
    visit("path", self.path);
    visit("elements", self.elements);
    visit("radius", self.radius);
    visit("wall", self.wall);
    visit("material", self.material);
    visit("ultimateStrain", self.ultimateStrain);
    visit("burnThrough", self.burnThrough);
    visit("friction", self.friction);
    visit("start", self.start);
    visit("end", self.end);
  }
};

/// How fat hangs on an organ or a vessel: springs over what of it is no farther than `distance`.
struct FatAttachmentDescription {
  std::string to;           ///< name of an organ or a vessel
  double distance = 0.002;  ///< from its rest surface (m)
  double stiffness = 2e6;   ///< of a unit volume of fat that hangs on it (N/m^4)
  double damping = 2e4;     ///< (N s/m^4)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("to", self.to);
    visit("distance", self.distance);
    visit("stiffness", self.stiffness);
    visit("damping", self.damping);
  }
};

/// Fat that the energised hook carves: a potential field over coarse cubes (sim/carving, sim/solid).
struct FatDescription {
  std::string name;
  std::string appearance;
  StructureRole role = StructureRole::other;
  SurfaceDescription surface;
  double cellSize = 0.00075;       ///< of the potential field (m)
  std::uint32_t cellsPerCube = 3;  ///< edge of a mechanical cube in cells
  MaterialDescription material{1000.0, 0.4, 920.0, 2.0, 0.01};
  double friction = 0.1;  ///< Coulomb coefficient of an instrument on it
  std::vector<FatAttachmentDescription> attachments;
  /// What is to be cleared, at rest: what lies over or under this triangle (m), no farther from its plane than
  std::array<Vec3, 3> triangle{Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  double triangleDepth = 0.0;  ///< m; 0: nothing

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("name", self.name);
    visit("appearance", self.appearance);
    visit("role", self.role);
    visit("surface", self.surface);
    visit("cellSize", self.cellSize);
    visit("cellsPerCube", self.cellsPerCube);
    visit("material", self.material);
    visit("friction", self.friction);
    visit("attachments", self.attachments);
    visit("triangle", self.triangle);
    visit("triangleDepth", self.triangleDepth);
  }
};

/// Where a hand's instrument enters, and how it is coupled.
struct HandDescription {
  Vec3 port = Vec3::Zero();  ///< p_WP, the trocar's pivot (m)
  Vec3 home = Vec3::Zero();  ///< p_WI at the start (m)
  InstrumentKind instrument = InstrumentKind::grasper;
  double shaftRadius = 0.0025;        ///< m
  double couplingStiffness = 1000.0;  ///< of the virtual coupling at the tip (N/m)
  double rollStiffness = 0.2;         ///< of the virtual coupling about the shaft (N m/rad)
  double largestForce = 8.0;          ///< what the device, and so the virtual coupling, can do (N)
  double slipForce = 4.0;             ///< pull at which closed jaws begin to lose tissue (N)
  std::uint32_t clips = 8;            ///< in its clip applier
  double tearForce = 6.0;             ///< pull at which tissue tears that is held faster (locked jaws) (N)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("port", self.port);
    visit("home", self.home);
    visit("instrument", self.instrument);
    visit("shaftRadius", self.shaftRadius);
    visit("couplingStiffness", self.couplingStiffness);
    visit("rollStiffness", self.rollStiffness);
    visit("largestForce", self.largestForce);
    visit("slipForce", self.slipForce);
    visit("clips", self.clips);
    visit("tearForce", self.tearForce);
  }
};

/// Clips, and from how near on they are too near.
struct ClipDescription {
  double width = 0.0012;            ///< along the vessel (m)
  double legs = 0.0085;             ///< from the crotch to the tips (m)
  double leastGap = 0.001;          ///< between two clips (m)
  double leastJunctionGap = 0.002;  ///< to a place where vessels meet (m)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("width", self.width);
    visit("legs", self.legs);
    visit("leastGap", self.leastGap);
    visit("leastJunctionGap", self.leastJunctionGap);
  }
};

/// What the energised hook does to what it touches.
struct CauteryDescription {
  double power = 30.0;    ///< W, all of it taken to go into the tissue touched
  double reach = 0.0003;  ///< farther than this from the hook's metal nothing is touched (m)
  double carve = 0.0008;  ///< fat goes that is no farther from the hook's metal (m)
  double spot = 2e-6;     ///< area that one touch covers (m^2)
  double charTime = 0.3;  ///< cautery at one spot from which on it counts as charred (s)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("power", self.power);
    visit("reach", self.reach);
    visit("carve", self.carve);
    visit("spot", self.spot);
    visit("charTime", self.charTime);
  }
};

/// A vessel that is to be clipped and cut, and how many clips should close it on each side of the cut.
struct DivideDescription {
  std::string vessel;
  std::uint32_t patient = 2;   ///< clips on the side that stays
  std::uint32_t specimen = 1;  ///< clips on the side that goes
  bool patientAtStart = true;  ///< the vessel's start is on the side that stays

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("vessel", self.vessel);
    visit("patient", self.patient);
    visit("specimen", self.specimen);
    visit("patientAtStart", self.patientAtStart);
  }
};

/// What is to be done in a scene (docs/procedure.md). Without a specimen there is nothing.
struct ProcedureDescription {
  std::string specimen;                   ///< organ that is to be freed
  std::string bed;                        ///< connective tissue that holds it
  std::string fat;                        ///< fat that hides the vessels, or nothing
  std::vector<DivideDescription> divide;  ///< the first ends where the bed's lower third begins
  std::vector<std::string> spare;         ///< vessels that must be neither clipped nor opened

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("specimen", self.specimen);
    visit("bed", self.bed);
    visit("fat", self.fat);
    visit("divide", self.divide);
    visit("spare", self.spare);
  }
};

/// An assistant's pull on an organ, by springs on its nodes inside a sphere.
struct RetractionDescription {
  std::string organ;
  Vec3 centre = Vec3::Zero();        ///< of the sphere, at rest (m)
  double radius = 0.01;              ///< m
  Vec3 displacement = Vec3::Zero();  ///< that the springs' far ends go (m)
  double start = 0.0;                ///< s
  double duration = 2.0;             ///< until they are there (s)
  double stiffness = 200.0;          ///< of all springs together (N/m)
  double damping = 2.0;              ///< (N s/m)

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("organ", self.organ);
    visit("centre", self.centre);
    visit("radius", self.radius);
    visit("displacement", self.displacement);
    visit("start", self.start);
    visit("duration", self.duration);
    visit("stiffness", self.stiffness);
    visit("damping", self.damping);
  }
};

struct SolverDescription {
  double tolerance = 1e-4;          ///< relative residual of the linear solve
  double speedTolerance = 1e-6;     ///< an error whose energy is that of a body at this speed ends a solve, too (m/s)
  std::uint32_t iterations = 200;   ///< cap of the linear solve
  double responseTolerance = 1e-3;  ///< relative residual of the solves that carry out changes of contact forces
  double responseSpeedTolerance = 3e-6;  ///< as speedTolerance, of those (m/s)
  double contactTolerance = 1e-8;        ///< residual of the contact problem (m)
  std::uint32_t contactPasses = 3;       ///< at most so often is it posed anew with the gaps that its forces left
  std::uint32_t contactIterations = 100;
  bool sleeping = true;  ///< untouched organs at rest are not solved

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("tolerance", self.tolerance);
    visit("speedTolerance", self.speedTolerance);
    visit("iterations", self.iterations);
    visit("responseTolerance", self.responseTolerance);
    visit("responseSpeedTolerance", self.responseSpeedTolerance);
    visit("contactTolerance", self.contactTolerance);
    visit("contactPasses", self.contactPasses);
    visit("contactIterations", self.contactIterations);
    visit("sleeping", self.sleeping);
  }
};

struct SceneDescription {
  std::string name;
  std::uint32_t majorVersion = 1;  ///< changes when attempts before and after must not be compared
  std::uint32_t minorVersion = 0;
  std::uint32_t ticksPerStep = 10;  ///< a tick is 1 ms
  Vec3 gravity = Vec3::Zero();      ///< m/s^2; zero: the organs' rest shape is their shape in the body, under gravity
  double timeLimit = 0.0;           ///< s; 0: none
  std::array<Vec3, 2> workspace{Vec3::Constant(-0.5), Vec3::Constant(0.5)};  ///< lower and upper corner for tips (m)
  std::vector<OrganDescription> organs;
  std::vector<ConnectiveDescription> connective;
  std::vector<VesselDescription> vessels;
  std::vector<FatDescription> fat;
  ProcedureDescription procedure;
  std::vector<RetractionDescription> retraction;
  std::array<HandDescription, handCount> hands;
  CameraSample camera;               ///< at the start
  double verticalFieldOfView = 1.0;  ///< rad
  ClipDescription clip;
  CauteryDescription cautery;
  SolverDescription solver;

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("name", self.name);
    visit("majorVersion", self.majorVersion);
    visit("minorVersion", self.minorVersion);
    visit("ticksPerStep", self.ticksPerStep);
    visit("gravity", self.gravity);
    visit("timeLimit", self.timeLimit);
    visit("workspace", self.workspace);
    visit("organs", self.organs);
    visit("connective", self.connective);
    visit("vessels", self.vessels);
    visit("fat", self.fat);
    visit("procedure", self.procedure);
    visit("retraction", self.retraction);
    visit("hands", self.hands);
    visit("cameraPosition", self.camera.position);
    visit("cameraOrientation", self.camera.orientation);
    visit("verticalFieldOfView", self.verticalFieldOfView);
    visit("clip", self.clip);
    visit("cautery", self.cautery);
    visit("solver", self.solver);
  }
};

inline constexpr double tickLength = 0.001;  ///< s

}  // namespace calot
