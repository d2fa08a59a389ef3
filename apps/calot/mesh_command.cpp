// SPDX-License-Identifier: GPL-3.0-or-later
// calot mesh: tetrahedra from a closed surface, with an honest report; repaired and coarser surfaces for scenes.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "apps/calot/command.h"
#include "apps/calot/mesh_report.h"
#include "recorder/base/counted.h"
#include "recorder/base/files.h"
#include "recorder/formats/mesh_file.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/surface_report.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::apps {
namespace {

struct CoarseSurface {
  std::string error;  ///< empty: the surface is good
  TriangleMesh mesh;
};

/// Share of the requested number.
constexpr double goodEnough = 0.1, acceptable = 0.3;
constexpr int searches = 8;

/// A closed surface of about this number of triangles: the boundary of a tetrahedral mesh (stuffToCount()) of the same
/// volume within 1 %. Thin parts go as they do there.
/// @param surface closed, outward, manifold
CoarseSurface coarseSurface(const TriangleMesh& surface, int triangles) {
  CoarseSurface best;
  if (triangles >= surface.triangles()) {
    best.error = fmt::format("the surface has {} triangles; --surface-triangles makes it coarser, not finer",
                             surface.triangles());
    return best;
  }
  double wanted = std::clamp(0.3 * triangles, 12.0, static_cast<double>(maxTetrahedronCount));
  double least = acceptable;
  std::string fault;
  for (int i = 0; i < searches; ++i) {
    StuffedMesh stuffed = stuffToCount(surface, static_cast<int>(std::lround(wanted)));
    if (!stuffed.ok()) {
      fault = stuffed.error;
      wanted *= 1.5;
    } else {
      TriangleMesh boundary = boundarySurface(stuffed.mesh);
      const double ratio = static_cast<double>(boundary.triangles()) / triangles;
      if (std::abs(ratio - 1.0) < least) {
        least = std::abs(ratio - 1.0);
        best.mesh = std::move(boundary);
      }
      if (least <= goodEnough) break;
      wanted *= std::pow(ratio, -1.5);  // area grows as the number of cells to the power of 2/3
    }
    wanted = std::clamp(wanted, 12.0, static_cast<double>(maxTetrahedronCount));
  }
  if (best.mesh.triangle.empty()) {
    best.error = fmt::format("no closed surface of about {} triangles was found{}", triangles,
                             fault.empty() ? "" : ": " + fault);
  }
  return best;
}

struct MeshOptions {
  std::string input;
  std::string unit;
  int tetrahedra = 0;
  std::string output, surfaceOutput;
  int surfaceTriangles = 0;
  bool repair = false, json = false, force = false;
};

/// Longest side of an organ's bounds (m): what scenes accept.
constexpr double leastSize = 0.001, mostSize = 1.0;

void checkFiles(const MeshOptions& o) {
  if (const std::string fault = recorder::surfaceNameFault(o.input); !fault.empty())
    throw Error(ErrorKind::invalid, Where{o.input}, fault);
  if (o.output.empty() && o.surfaceOutput.empty())
    throw Error(ErrorKind::invalid, "mesh: -o F.vtk writes tetrahedra, --surface-output F.obj the surface");
  if (!o.output.empty() && !o.output.ends_with(".vtk"))
    throw Error(ErrorKind::invalid, o.output + ": the output's name must end in .vtk");
  if (!o.output.empty() && o.tetrahedra == 0)
    throw Error(ErrorKind::invalid, "mesh: --tetrahedra gives the number of tetrahedra");
  if (!o.surfaceOutput.empty() && !o.surfaceOutput.ends_with(".obj"))
    throw Error(ErrorKind::invalid, o.surfaceOutput + ": the surface's name must end in .obj");
  for (const std::string& file : {o.output, o.surfaceOutput}) {
    if (!file.empty()) recorder::refuseOutput(file, o.force);
  }
}

/// A surface of a size that no organ has, and which units would make it one.
void checkUnit(const MeshOptions& o, const SurfaceReport& found) {
  if (found.triangles == 0) return;
  const double size = (found.box.upper - found.box.lower).maxCoeff();
  if (size >= leastSize && size <= mostSize) return;
  const double own = o.unit == "m" ? 1.0 : o.unit == "cm" ? 0.01 : 0.001;
  std::string fitting;
  for (const auto& [name, length] : {std::pair{"m", 1.0}, std::pair{"cm", 0.01}, std::pair{"mm", 0.001}}) {
    const double other = size / own * length;
    if (other >= leastSize && other <= mostSize)
      fitting += fmt::format("{}--unit {} ({:.4g} mm)", fitting.empty() ? "" : " or ", name, 1000.0 * other);
  }
  throw Error(ErrorKind::invalid, fmt::format("{}: {:.4g} m long in {}; an organ is 1 mm to 1 m long{}", o.input, size,
                                              o.unit, fitting.empty() ? std::string() : ": " + fitting + " would fit"));
}

/// Explains why a surface has no interior; empty if it has one.
std::string openFault(const MeshOptions& o, const MeshReport& report, const SurfaceReport& now) {
  if (now.openEdges > 0) {
    std::string holes;
    std::size_t left = 0;
    for (const SurfaceHole& hole : report.mended.holes) {
      if (hole.area > 0.0) continue;
      if (++left <= 3) holes += (holes.empty() ? ": " : "; ") + wordsFor(hole);
    }
    if (left > 3) holes += "; ...";
    return fmt::format("the surface is open: {}, {}{}{}", recorder::counted(now.openEdges, "edge"),
                       recorder::counted(left, "hole"), holes, o.repair ? "" : "; --repair fills holes");
  }
  if (now.nonManifoldEdges > 0)
    return fmt::format("{} edges have more than two triangles: what is inside there is not defined",
                       now.nonManifoldEdges);
  return {};
}

void writeOutputs(const MeshOptions& o, const TriangleMesh& surface, MeshReport& report) {
  const std::string title = "calot mesh of " + o.input + ", metres";
  TriangleMesh written = surface;
  if (o.surfaceTriangles > 0) {
    CoarseSurface coarse = coarseSurface(surface, o.surfaceTriangles);
    if (!coarse.error.empty()) {
      report.faults.push_back(coarse.error);
      return;
    }
    written = std::move(coarse.mesh);
  }
  if (!o.output.empty()) {
    report.stuffed = stuffToCount(surface, o.tetrahedra);
    if (!report.stuffed.ok()) {
      report.faults.push_back(report.stuffed.error);
      return;
    }
    recorder::writeText(o.output, recorder::formatVtk(report.stuffed.mesh, title), o.force);
    report.output = o.output;
  }
  if (o.surfaceOutput.empty()) return;
  recorder::writeText(o.surfaceOutput, recorder::formatObj(written, title), o.force);
  report.surfaceOutput = o.surfaceOutput;
  report.surfaceTriangles = written.triangles();
  report.surfaceOutputVolume = signedVolume(written);
}

void meshSurface(const MeshOptions& o) {
  checkFiles(o);
  Progress progress("Meshing", o.json);
  MeshReport report;
  report.input = o.input;
  report.unit = o.unit;
  const TriangleMesh surface = recorder::readSurface(o.input, recorder::parseLengthUnit(o.unit), {}, &report.notes);
  try {
    report.mended = recorder::mendSurface(surface, o.repair);
  } catch (const Error& e) {
    throw Error(e.kind(), Where{o.input}, fmt::format("parts of the surface overlap: {}", e.what()));
  }
  const TriangleMesh& whole = report.mended.mesh;
  report.found = inspectSurface(surface);
  report.found.box = bounds(whole);  // a vertex that no triangle uses may be anywhere
  checkUnit(o, report.found);
  if (const std::string fault = openFault(o, report, inspectSurface(whole)); !fault.empty()) {
    report.faults.push_back(fault);
  } else {
    writeOutputs(o, whole, report);
  }
  printResult(o.json, "mesh", meshReportJson(report), meshReportText(report));
  for (const std::string& warning : meshWarnings(report))
    fmt::print(stderr, "calot: warning: {}: {}\n", o.input, warning);
  if (!report.faults.empty()) throw Error(ErrorKind::refused, o.input + ": " + report.faults.front());
}

}  // namespace

void addMesh(CLI::App& app, Run& run) {
  const auto [command, options] =
      addCommand(app, run,
                 {"mesh", "Fill a closed surface with tetrahedra (isosurface stuffing); repair a surface for a scene",
                  "calot mesh liver.stl --unit mm --tetrahedra 1500 -o liver.vtk",
                  "calot mesh liver.stl --unit mm --repair --surface-output organs/liver.obj --surface-triangles 6000"},
                 meshSurface);
  command->add_option("surface", options->input, "the surface, a .obj, .stl, .ply or .off file")->required();
  command->add_option("--unit", options->unit, "of the file's coordinates: m, cm or mm")
      ->required()
      ->check(oneOf({"m", "cm", "mm"}));
  command->add_option("--tetrahedra", options->tetrahedra, "their number")->check(CLI::Range(12, maxTetrahedronCount));
  command->add_option("-o,--output", options->output, "the mesh to write, a .vtk file");
  CLI::Option* surface = command->add_option("--surface-output", options->surfaceOutput,
                                             "the closed surface to write, a .obj file in metres, for scenes");
  command
      ->add_option("--surface-triangles", options->surfaceTriangles,
                   "remesh that surface with about this number of triangles")
      ->check(CLI::Range(100, 1'000'000))
      ->needs(surface);
  command->add_flag("--repair", options->repair, "fill holes");
  command->add_flag("--json", options->json, "print the report as JSON");
  command->add_flag("--force", options->force, "replace files that are there");
}

}  // namespace calot::apps
