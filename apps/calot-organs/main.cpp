// SPDX-License-Identifier: GPL-3.0-or-later
// calot-organs: writes the organ surfaces of assets/organs, or checks that they are what it would write.
#include <fmt/format.h>

#include <algorithm>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/calot-organs/organ_shapes.h"
#include "apps/common/program.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/formats/mesh_file.h"
#include "sim/geometry/surface_report.h"

namespace {

struct Organ {
  std::string file;
  calot::TriangleMesh mesh;
  std::string head;
};

int run(const std::filesystem::path& folder, bool check, bool force) {
  using namespace calot;
  const std::vector<Organ> organs{
      {"liver.obj", organs::makeLiver(), organs::headOf("Liver of an adult")},
      {"gallbladder.obj", organs::makeGallbladder(), organs::headOf("Gallbladder of an adult")},
      {"fat.obj", organs::makeFat(), organs::headOf("Fat over Calot's triangle")}};
  int result = 0;
  for (const Organ& organ : organs) {
    const SurfaceReport report = inspectSurface(organ.mesh);
    if (!report.closedManifold() || report.components != 1) {
      throw Error(ErrorKind::failure, organ.file + ": the shape's surface is not one closed manifold");
    }
    if (findSelfCrossing(organ.mesh).pairs > 0) {
      throw Error(ErrorKind::failure, organ.file + ": the shape's surface passes through itself");
    }
    const Vec3 size = 1000.0 * (report.box.upper - report.box.lower);
    fmt::print("{}: {} triangles, {:.1f} mL, {:.0f} x {:.0f} x {:.0f} mm\n", organ.file, report.triangles,
               1e6 * report.volume, size[0], size[1], size[2]);
    const std::filesystem::path path = folder / organ.file;
    if (!check) {
      recorder::writeText(path, recorder::formatObj(organ.mesh, organ.head), force);
      continue;
    }
    const std::string wanted = recorder::formatObj(organ.mesh, organ.head);
    const auto found = recorder::readFileBytes(path, path.string(), wanted.size() + 1'000'000);
    const bool same = std::equal(found.begin(), found.end(), wanted.begin(), wanted.end(),
                                 [](std::byte x, char y) { return x == static_cast<std::byte>(y); });
    fmt::print("{}: {}\n", path.string(), same ? "as made" : "differs");
    if (!same) result = static_cast<int>(apps::ExitCode::no);
  }
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Makes the organ surfaces liver.obj, gallbladder.obj and fat.obj from implicit shapes.", "calot-organs");
  std::string folder;
  bool check = false, force = false;
  app.add_option("folder", folder, "where to write them")->required();
  app.add_flag("--check", check, "write nothing; exit 3 where a file differs from what would be written");
  app.add_flag("--force", force, "replace files that are there");
  return calot::apps::runProgram(app, argc, argv, [&] { return run(folder, check, force); });
}
