// SPDX-License-Identifier: GPL-3.0-or-later
// calot mesh: tetrahedra from a closed surface, with an honest report; repaired and coarser surfaces for scenes.
#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "apps/calot/command.h"
#include "recorder/base/files.h"
#include "recorder/formats/mesh_file.h"
#include "recorder/formats/scene_assets.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/surface_report.h"
#include "sim/geometry/triangle_mesh.h"

namespace calot::apps {
namespace {

/// A surface and what `calot mesh` made of it.
struct MeshReport {
  std::string input;                ///< the file's name
  std::string unit;                 ///< as given: m, cm, mm
  std::string output;               ///< empty when no mesh was written
  SurfaceReport found;              ///< the surface as it was read
  SurfaceRepair repair;             ///< repairs before meshing that invent nothing
  std::vector<SurfaceHole> holes;   ///< of the repaired surface
  SelfCrossing crossing;            ///< of the surface that is meshed
  StuffedMesh stuffed;              ///< the mesh, or the reason for its absence; empty without --tetrahedra
  std::string surfaceOutput;        ///< empty when no surface was written
  int surfaceTriangles = 0;         ///< of what was written
  double surfaceOutputVolume = 0;   ///< m^3
  std::vector<std::string> faults;  ///< why there is no mesh or surface
};

constexpr double perDegree = 3.14159265358979323846 / 180.0;

Json coordinates(const Vec3& v) { return {v[0], v[1], v[2]}; }

Json inputJson(const MeshReport& report) {
  const SurfaceReport& found = report.found;
  Json json;
  json["file"] = report.input;
  json["unit"] = report.unit;
  json["vertices"] = found.vertices;
  json["triangles"] = found.triangles;
  json["components"] = found.components;
  json["closed"] = found.closedManifold();
  json["open_edges"] = found.openEdges;
  json["holes"] = found.holes;
  json["non_manifold_edges"] = found.nonManifoldEdges;
  json["flipped_edges"] = found.flippedEdges;
  json["inward_components"] = found.inwardComponents;
  json["cavities"] = found.cavities;
  json["duplicate_triangles"] = found.duplicateTriangles;
  json["degenerate_triangles"] = found.degenerateTriangles;
  json["coincident_vertices"] = found.coincidentVertices;
  json["unused_vertices"] = found.unusedVertices;
  json["area_m2"] = found.area;
  json["volume_m3"] = found.volume;
  json["lower_m"] = coordinates(found.box.lower);
  json["upper_m"] = coordinates(found.box.upper);
  json["repaired"] = {{"welded_vertices", report.repair.weldedVertices},
                      {"dropped_degenerate", report.repair.droppedDegenerate},
                      {"dropped_duplicates", report.repair.droppedDuplicates},
                      {"dropped_vertices", report.repair.droppedVertices},
                      {"flipped_triangles", report.repair.flippedTriangles}};
  return json;
}

Json holesJson(const MeshReport& report) {
  Json holes = Json::array();
  for (const SurfaceHole& hole : report.holes) {
    holes.push_back({{"edges", hole.vertex.size()},
                     {"centre_m", coordinates(hole.centre)},
                     {"perimeter_m", hole.perimeter},
                     {"filled", hole.area > 0.0},
                     {"area_m2", hole.area}});
    if (!hole.fault.empty()) holes.back()["fault"] = hole.fault;
  }
  return holes;
}

/// Result of stuffToCount(); empty for a mesh that was not requested.
void addStuffed(Json& json, const StuffedMesh& stuffed) {
  const StuffingReport& r = stuffed.report;
  if (r.requested == 0) return;
  json["requested"] = r.requested;
  json["tetrahedra"] = r.tetrahedra;
  json["vertices"] = stuffed.mesh.vertex.size();
  json["count_error"] = r.countError;
  json["volume_m3"] = r.meshVolume;
  json["surface_volume_m3"] = r.surfaceVolume;
  json["volume_error"] = r.volumeError;
  json["cell_size_m"] = stuffed.cellSize;
  json["level_offset_m"] = stuffed.levelOffset;
  json["surface_distance_m"] = std::max(r.surfaceToMesh, r.meshToSurface);
  json["surface_to_mesh_m"] = r.surfaceToMesh;
  json["mesh_to_surface_m"] = r.meshToSurface;
  json["dihedral_min_deg"] = r.dihedralMin / perDegree;
  json["dihedral_max_deg"] = r.dihedralMax / perDegree;
  json["lost_area"] = r.lostArea;
  json["lost_distance_m"] = r.lostDistance;
  json["lost_parts"] = r.lostParts;
  json["lost_where_m"] = coordinates(r.lostWhere);
  json["lost_components"] = r.lostComponents;
  json["dropped_pieces"] = r.droppedPieces;
  json["dropped_volume_m3"] = r.droppedVolume;
}

/// "70 edges around (12.1, -3.4, 50.0) mm".
std::string wordsFor(const SurfaceHole& hole) {
  const Vec3 at = 1000.0 * hole.centre;
  return fmt::format("{} edges around ({:.1f}, {:.1f}, {:.1f}) mm", hole.vertex.size(), at[0], at[1], at[2]);
}

/// Differences between output and input, one line each: parts that were dropped or are too thin,
/// holes that were filled, a surface that crosses itself.
std::vector<std::string> meshWarnings(const MeshReport& report) {
  std::vector<std::string> warnings;
  std::size_t filled = 0;
  double area = 0.0;
  for (const SurfaceHole& hole : report.holes) {
    filled += hole.area > 0.0 ? 1 : 0;
    area += hole.area;
  }
  if (filled > 0) {
    warnings.push_back(fmt::format("{} hole{} filled with {:.1f} mm^2 of surface that the file has not", filled,
                                   filled == 1 ? " was" : "s were", 1e6 * area));
  }
  const SurfaceRepair& repair = report.repair;
  if (const int dropped = repair.droppedDegenerate + repair.droppedDuplicates; dropped > 0)
    warnings.push_back(fmt::format("{} triangles were dropped: {}", dropped, recorder::repairSummary(repair)));
  if (report.crossing.pairs > 0) {
    const Vec3 at = 1000.0 * report.crossing.where;
    warnings.push_back(
        fmt::format("the surface crosses itself at {} pairs of triangles, first at ({:.1f}, {:.1f}, {:.1f}) mm",
                    report.crossing.pairs, at[0], at[1], at[2]));
  }
  const StuffingReport& r = report.stuffed.report;
  if (r.droppedPieces > 0) {
    warnings.push_back(fmt::format("{} loose piece{} of the mesh left out ({:.3f} mL)", r.droppedPieces,
                                   r.droppedPieces == 1 ? " was" : "s were", 1e6 * r.droppedVolume));
  }
  if (r.lostComponents > 0)
    warnings.push_back(fmt::format("{} of {} components of the surface are not in the mesh", r.lostComponents,
                                   report.found.components));
  if (r.lostParts > 0) {
    const Vec3 at = 1000.0 * r.lostWhere;
    warnings.push_back(fmt::format(
        "{:.2f} % of the surface, in {} thin part{}, is farther than {:.2f} mm from the mesh; worst at "
        "({:.1f}, {:.1f}, {:.1f}) mm",
        100.0 * r.lostArea, r.lostParts, r.lostParts == 1 ? "" : "s", 1000.0 * r.lostDistance, at[0], at[1], at[2]));
  }
  return warnings;
}

/// Its members: docs/reference/meshing.md.
Json meshReportJson(const MeshReport& report) {
  Json json;
  json["ok"] = report.faults.empty();
  if (!report.faults.empty()) json["error"] = report.faults.front();
  addStuffed(json, report.stuffed);
  if (!report.output.empty()) json["output"] = report.output;
  if (!report.surfaceOutput.empty()) {
    json["surface_output"] = report.surfaceOutput;
    json["surface_output_triangles"] = report.surfaceTriangles;
    json["surface_output_volume_m3"] = report.surfaceOutputVolume;
  }
  json["holes"] = holesJson(report);
  json["self_crossing_pairs"] = report.crossing.pairs;
  json["warnings"] = meshWarnings(report);
  json["input"] = inputJson(report);
  return json;
}

/// The same as text of several lines.
std::string meshReportText(const MeshReport& report) {
  const SurfaceReport& in = report.found;
  const StuffedMesh& stuffed = report.stuffed;
  const StuffingReport& r = stuffed.report;
  std::string text;
  const auto out = std::back_inserter(text);
  const Vec3 size = 1000.0 * (in.box.upper - in.box.lower);
  fmt::format_to(out, "surface            {}: {} vertices, {} triangles, {} component{}, {:.1f} x {:.1f} x {:.1f} mm\n",
                 report.input, in.vertices, in.triangles, in.components, in.components == 1 ? "" : "s", size[0],
                 size[1], size[2]);
  if (in.closedManifold()) {
    fmt::format_to(out, "                   closed and consistently outward\n");
  } else {
    fmt::format_to(
        out, "                   {} open edges, {} non-manifold edges, {} flipped edges, {} components turned inward\n",
        in.openEdges, in.nonManifoldEdges, in.flippedEdges, in.inwardComponents);
  }
  if (in.degenerateTriangles + in.duplicateTriangles + in.coincidentVertices + in.unusedVertices > 0) {
    fmt::format_to(out,
                   "                   {} triangles without area, {} duplicate, {} coincident and {} unused vertices\n",
                   in.degenerateTriangles, in.duplicateTriangles, in.coincidentVertices, in.unusedVertices);
  }
  if (report.repair.changed()) fmt::format_to(out, "put right          {}\n", recorder::repairSummary(report.repair));
  for (const SurfaceHole& hole : report.holes) {
    fmt::format_to(out, "hole               {}, {:.1f} mm round: {}\n", wordsFor(hole), 1000.0 * hole.perimeter,
                   hole.area > 0.0      ? fmt::format("filled with {:.1f} mm^2", 1e6 * hole.area)
                   : hole.fault.empty() ? std::string("open")
                                        : "not filled: " + hole.fault);
  }
  if (!report.surfaceOutput.empty()) {
    fmt::format_to(out, "surface written    {}: {} triangles, {:.3f} mL, m\n", report.surfaceOutput,
                   report.surfaceTriangles, 1e6 * report.surfaceOutputVolume);
  }
  if (stuffed.mesh.tetrahedron.empty()) return text;
  fmt::format_to(out, "tetrahedra         {} of {} requested ({:+.1f} %)\n", r.tetrahedra, r.requested,
                 100.0 * (static_cast<double>(r.tetrahedra) / static_cast<double>(r.requested) - 1.0));
  fmt::format_to(out, "volume             {:.3f} mL, surface {:.3f} mL ({:+.2f} %)\n", 1e6 * r.meshVolume,
                 1e6 * r.surfaceVolume, 100.0 * (r.meshVolume / r.surfaceVolume - 1.0));
  fmt::format_to(out, "cell size          {:.3f} mm\n", 1000.0 * stuffed.cellSize);
  fmt::format_to(out, "level-set offset   {:+.3f} mm\n", 1000.0 * stuffed.levelOffset);
  fmt::format_to(out, "largest distance   {:.2f} mm from surface to mesh, {:.2f} mm from mesh to surface\n",
                 1000.0 * r.surfaceToMesh, 1000.0 * r.meshToSurface);
  fmt::format_to(out, "dihedral angles    {:.2f} to {:.2f} degrees\n", r.dihedralMin / perDegree,
                 r.dihedralMax / perDegree);
  if (r.lostParts + r.lostComponents + r.droppedPieces == 0) {
    fmt::format_to(out, "thin parts         none lost (none farther than {:.2f} mm)\n", 1000.0 * r.lostDistance);
  } else {
    fmt::format_to(
        out,
        "thin parts         {:.2f} % of the surface, in {} parts, lies farther than {:.2f} mm from the mesh; "
        "worst at ({:.4f}, {:.4f}, {:.4f}) m; {} components lost; {} loose pieces left out ({:.3f} mL)\n",
        100.0 * r.lostArea, r.lostParts, 1000.0 * r.lostDistance, r.lostWhere[0], r.lostWhere[1], r.lostWhere[2],
        r.lostComponents, r.droppedPieces, 1e6 * r.droppedVolume);
  }
  if (!report.output.empty()) fmt::format_to(out, "written            {}\n", report.output);
  return text;
}

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
  if (!recorder::isSurfaceName(o.input))
    throw Error(ErrorKind::invalid, o.input + ": surfaces are read from .obj, .stl and .ply files");
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
    for (const SurfaceHole& hole : report.holes) {
      if (hole.area > 0.0) continue;
      if (++left <= 3) holes += (holes.empty() ? ": " : "; ") + wordsFor(hole);
    }
    if (left > 3) holes += "; ...";
    return fmt::format("the surface is open: {} edges, {} holes{}{}", now.openEdges, left, holes,
                       o.repair ? "" : "; --repair fills holes");
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
  MeshReport report;
  report.input = o.input;
  report.unit = o.unit;
  const TriangleMesh surface = recorder::readSurface(o.input, recorder::parseLengthUnit(o.unit));
  report.found = inspectSurface(surface);
  checkUnit(o, report.found);
  report.repair = repairSurface(surface);
  TriangleMesh whole = report.repair.mesh;
  if (o.repair) {
    HoleFilling filling = fillHoles(whole);
    report.holes = std::move(filling.holes);
    // Once more: only of a closed surface is it known what is outside.
    SurfaceRepair closed = repairSurface(filling.mesh);
    report.repair.flippedTriangles += closed.flippedTriangles;
    whole = std::move(closed.mesh);
  } else {
    report.holes = findHoles(whole);
  }
  if (const std::string fault = openFault(o, report, inspectSurface(whole)); !fault.empty()) {
    report.faults.push_back(fault);
  } else {
    report.crossing = findSelfCrossing(whole);
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
  command->add_option("surface", options->input, "the surface, a .obj, .stl or .ply file")->required();
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
