// SPDX-License-Identifier: GPL-3.0-or-later
// calot mesh: tetrahedra from a closed surface, with an honest report.
#include <fmt/format.h>

#include <memory>
#include <string>

#include "apps/calot/commands.h"
#include "apps/common/exit_code.h"
#include "recorder/errors.h"
#include "recorder/formats/mesh_report.h"
#include "recorder/formats/surface_file.h"
#include "recorder/formats/text_output.h"
#include "recorder/formats/vtk.h"

namespace calot::apps {
namespace {

struct MeshOptions {
  std::string input;
  std::string unit;
  int tetrahedra = 0;
  std::string output;
  bool json = false;
  bool force = false;
};

int meshSurface(const MeshOptions& options) {
  if (!recorder::isSurfaceName(options.input)) {
    throw Error(ErrorKind::invalid, options.input + ": surfaces are read from .obj, .stl and .ply files");
  }
  if (!options.output.ends_with(".vtk"))
    throw Error(ErrorKind::invalid, options.output + ": the output's name must end in .vtk");
  recorder::refuseOutput(options.output, options.force);

  recorder::MeshReport report;
  report.input = options.input;
  report.unit = options.unit;
  const TriangleMesh surface = recorder::readSurface(options.input, recorder::parseLengthUnit(options.unit));
  report.found = inspectSurface(surface);
  report.repair = repairSurface(surface);
  report.stuffed = stuffToCount(report.repair.mesh, options.tetrahedra);
  if (report.stuffed.ok()) {
    recorder::writeVtk(options.output, report.stuffed.mesh, "calot mesh of " + options.input + ", metres",
                       options.force);
    report.output = options.output;
  }
  fmt::print("{}", options.json ? recorder::meshReportJson(report) : recorder::meshReportText(report));
  if (!report.stuffed.ok()) throw Error(ErrorKind::refused, options.input + ": " + report.stuffed.error);
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

void addMesh(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("mesh", "Fill a closed surface with tetrahedra (isosurface stuffing)");
  const auto options = std::make_shared<MeshOptions>();
  command->add_option("surface", options->input, "the surface, a .obj, .stl or .ply file")->required();
  command->add_option("--unit", options->unit, "of the file's coordinates: m, cm or mm")
      ->required()
      ->check(CLI::IsMember({"m", "cm", "mm"}));
  command->add_option("--tetrahedra", options->tetrahedra, "how many are wanted")
      ->required()
      ->check(CLI::Range(12, maxTetrahedronCount));
  command->add_option("-o,--output", options->output, "the mesh to write, a .vtk file")->required();
  command->add_flag("--json", options->json, "print the report as JSON");
  command->add_flag("--force", options->force, "replace a file that is there");
  command->callback([options, &run] { run = [options] { return meshSurface(*options); }; });
}

}  // namespace calot::apps
