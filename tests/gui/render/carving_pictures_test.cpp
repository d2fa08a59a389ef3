// SPDX-License-Identifier: GPL-3.0-or-later
// The paper's Fig. 5 as a pair of pictures: the same strokes on tetrahedra and on a potential field. The folder that
// CALOT_PICTURES names, or the one for temporary files, gets them.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "gui/render/image.h"
#include "gui/render/renderer.h"
#include "sim/carving/carved_field.h"
#include "sim/carving/carved_surface.h"
#include "tests/sim/carving/support/carving_bodies.h"
#include "tests/sim/carving/support/tetrahedra_removal.h"

namespace calot::gui {
namespace {

constexpr std::uint64_t seed = 5;
constexpr int strokes = 90;
constexpr int width = 800;
constexpr int height = 560;

TriangleMesh carvedTetrahedra() {
  Random random(seed, 11);
  test::TetrahedraRemoval body({{-0.020, -0.015, -0.008}, {0.020, 0.015, 0.008}}, 0.002,
                               test::insideSlab);  // whole cubes
  for (int i = 0; i < strokes; ++i) body.stroke(test::slabStroke(random));
  return body.faces();
}

TriangleMesh carvedField() {
  Random random(seed, 11);
  const BrickLattice lattice(Vec3::Constant(-0.024), 0.00075, Index3::Constant(65));
  const FieldModel model = test::fieldOf(lattice, 3.0, test::slabDistance);
  CarvedField field(model);
  CarvedBricks state;
  Islands islands(lattice, test::floorAnchors(lattice));
  islands.rebuild(field);
  for (int i = 0; i < strokes; ++i) {
    field.begin();
    test::carveAtRest(field, test::slabStroke(random));
    islands.remove(field);
    field.commit(state);
  }
  AdaptiveSurface surface(lattice);
  surface.rebuild(field);
  return surface.mesh();
}

/// The body from above and in front.
SceneView viewOf(TriangleMesh mesh) {
  SceneView view;
  SurfaceView& surface = view.surface.emplace_back();
  surface.organ = "body";
  surface.appearance = "fat";
  surface.rest = mesh.vertex;
  surface.position = std::move(mesh.vertex);
  surface.triangle = std::move(mesh.triangle);
  view.verticalFieldOfView = 0.6;
  view.camera.position = Vec3(0.012, -0.046, 0.050);
  Mat3 axes;
  axes.col(2) = (Vec3(0.0, 0.0, -0.002) - view.camera.position).normalized();
  axes.col(0) = axes.col(2).cross(Vec3::UnitZ()).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  view.camera.orientation = Quat(axes);
  return view;
}

/// Regions of pixels that show something, connected by sides.
int regionsOf(const Image& image) {
  std::vector<int> region(static_cast<std::size_t>(image.width * image.height), -1);
  int count = 0;
  std::vector<int> open;
  for (int start = 0; start < image.width * image.height; ++start) {
    if (region[static_cast<std::size_t>(start)] >= 0 || image.pixel(start % image.width, start / image.width)[3] == 0) {
      continue;
    }
    open.assign(1, start);
    region[static_cast<std::size_t>(start)] = count;
    while (!open.empty()) {
      const int at = open.back();
      open.pop_back();
      const int x = at % image.width;
      const int y = at / image.width;
      for (const auto& [nx, ny] : {std::pair(x - 1, y), {x + 1, y}, {x, y - 1}, {x, y + 1}}) {
        if (nx < 0 || ny < 0 || nx >= image.width || ny >= image.height) continue;
        const int next = ny * image.width + nx;
        if (region[static_cast<std::size_t>(next)] >= 0 || image.pixel(nx, ny)[3] == 0) continue;
        region[static_cast<std::size_t>(next)] = count;
        open.push_back(next);
      }
    }
    ++count;
  }
  return count;
}

std::filesystem::path folder() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): the only thread that asks
  const char* const asked = std::getenv("CALOT_PICTURES");
  return asked != nullptr ? asked : testing::TempDir();
}

TEST(CarvingPictures, FieldAgainstRemovalOfTetrahedra) {
  Renderer renderer;
  RenderSettings bare;
  bare.endoscopeMask = false;
  bare.cavity = false;
  const Image removal = renderer.render(viewOf(carvedTetrahedra()), width, height, bare);
  const Image field = renderer.render(viewOf(carvedField()), width, height, bare);
  writePng(removal, folder() / "carving-removal-of-tetrahedra.png");
  writePng(field, folder() / "carving-potential-field.png");
  EXPECT_EQ(regionsOf(field), 1) << "nothing floats";
  const auto shown = [](const Image& image) {
    int pixels = 0;
    for (int i = 0; i < image.width * image.height; ++i) {
      pixels += image.pixel(i % image.width, i / image.width)[3] > 0 ? 1 : 0;
    }
    return pixels;
  };
  EXPECT_NEAR(shown(removal), shown(field), 0.1 * shown(field)) << "the same body with the same strokes";
}

}  // namespace
}  // namespace calot::gui
