// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/tables.h"
#include "recorder/recording/probe.h"

namespace calot::recorder {
namespace {

struct Sent {
  std::vector<Vec3> vertex;
  std::vector<Index3> triangle;
  static void fields(auto& self, auto& visit) {
    visit("vertex", self.vertex);
    visit("triangle", self.triangle);
  }
};

}  // namespace

/// Joins in a child process: on some surfaces CGAL ends its program.
TriangleMesh uniteSurfaces(const std::vector<TriangleMesh>& piece) {
  const auto unite = apps::module<apps::SurfaceModule>().unite;
  try {
    Sent sent = guardedRecord("the union", [&] {
      TriangleMesh united = unite(piece);
      return Sent{std::move(united.vertex), std::move(united.triangle)};
    });
    return {std::move(sent.vertex), std::move(sent.triangle)};
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::damaged) throw;
    throw Error(ErrorKind::refused, "the library that joins them fails on these");
  }
}

}  // namespace calot::recorder
