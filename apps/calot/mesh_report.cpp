// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/mesh_report.h"

#include <fmt/format.h>
#include <algorithm>
#include <iterator>

#include "recorder/base/counted.h"
#include "recorder/formats/scene_assets.h"

namespace calot::apps {
namespace {

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
  json["repaired"] = {{"welded_vertices", report.mended.repair.weldedVertices},
                      {"dropped_degenerate", report.mended.repair.droppedDegenerate},
                      {"dropped_duplicates", report.mended.repair.droppedDuplicates},
                      {"dropped_vertices", report.mended.repair.droppedVertices},
                      {"flipped_triangles", report.mended.repair.flippedTriangles}};
  return json;
}

Json holesJson(const MeshReport& report) {
  Json holes = Json::array();
  for (const SurfaceHole& hole : report.mended.holes) {
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
void addStuffed(Json& json, const MeshReport& report) {
  const StuffedMesh& stuffed = report.stuffed;
  const StuffingReport& r = stuffed.report;
  if (r.requested == 0) return;
  json["requested"] = r.requested;
  json["tetrahedra"] = r.tetrahedra;
  json["vertices"] = stuffed.mesh.vertex.size();
  json["count_error"] = r.countError;
  json["volume_m3"] = r.meshVolume;
  json["surface_volume_m3"] = r.surfaceVolume;
  if (report.mended.crossing.pairs == 0) json["volume_error"] = r.volumeError;
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

}  // namespace

std::string wordsFor(const SurfaceHole& hole) {
  const Vec3 at = 1000.0 * hole.centre;
  return fmt::format("{} edges around ({:.1f}, {:.1f}, {:.1f}) mm", hole.vertex.size(), at[0], at[1], at[2]);
}

std::vector<std::string> meshWarnings(const MeshReport& report) {
  std::vector<std::string> warnings = report.notes;
  warnings.insert(warnings.end(), report.mended.notes.begin(), report.mended.notes.end());
  std::size_t filled = 0;
  double area = 0.0;
  for (const SurfaceHole& hole : report.mended.holes) {
    filled += hole.area > 0.0 ? 1 : 0;
    area += hole.area;
  }
  if (filled > 0) {
    warnings.push_back(fmt::format("{} hole{} filled with {:.1f} mm^2 of surface that the file has not", filled,
                                   filled == 1 ? " was" : "s were", 1e6 * area));
  }
  const SurfaceRepair& repair = report.mended.repair;
  if (const int dropped = repair.droppedDegenerate + repair.droppedDuplicates; dropped > 0)
    warnings.push_back(fmt::format("{} triangles were dropped: {}", dropped, recorder::repairSummary(repair)));
  if (report.mended.crossing.pairs > 0) {
    const Vec3 at = 1000.0 * report.mended.crossing.where;
    warnings.push_back(
        fmt::format("the surface crosses itself at {} pairs of triangles, first at ({:.1f}, {:.1f}, {:.1f}) mm: its "
                    "volume counts what it winds around twice, and the error of the mesh's volume is not known",
                    report.mended.crossing.pairs, at[0], at[1], at[2]));
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

Json meshReportJson(const MeshReport& report) {
  Json json;
  json["ok"] = report.faults.empty();
  if (!report.faults.empty()) json["error"] = report.faults.front();
  addStuffed(json, report);
  if (!report.output.empty()) json["output"] = report.output;
  if (!report.surfaceOutput.empty()) {
    json["surface_output"] = report.surfaceOutput;
    json["surface_output_triangles"] = report.surfaceTriangles;
    json["surface_output_volume_m3"] = report.surfaceOutputVolume;
  }
  json["holes"] = holesJson(report);
  json["self_crossing_pairs"] = report.mended.crossing.pairs;
  json["warnings"] = meshWarnings(report);
  json["input"] = inputJson(report);
  return json;
}

std::string meshReportText(const MeshReport& report) {
  const SurfaceReport& in = report.found;
  const StuffedMesh& stuffed = report.stuffed;
  const StuffingReport& r = stuffed.report;
  std::string text;
  const auto out = std::back_inserter(text);
  const Vec3 size = 1000.0 * (in.box.upper - in.box.lower);
  fmt::format_to(out, "surface            {}: {} vertices, {} triangles, {}, {:.1f} x {:.1f} x {:.1f} mm\n",
                 report.input, in.vertices, in.triangles, recorder::counted(in.components, "component"), size[0],
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
  if (report.mended.repair.changed())
    fmt::format_to(out, "put right          {}\n", recorder::repairSummary(report.mended.repair));
  for (const auto& notes : {report.notes, report.mended.notes}) {
    for (const std::string& note : notes) fmt::format_to(out, "changed            {}\n", note);
  }
  for (const SurfaceHole& hole : report.mended.holes) {
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
  fmt::format_to(
      out, "volume             {:.3f} mL, surface {:.3f} mL ({})\n", 1e6 * r.meshVolume, 1e6 * r.surfaceVolume,
      report.mended.crossing.pairs > 0 ? "crosses itself: error not known"
                                       : fmt::format("{:+.2f} %", 100.0 * (r.meshVolume / r.surfaceVolume - 1.0)));
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

}  // namespace calot::apps
