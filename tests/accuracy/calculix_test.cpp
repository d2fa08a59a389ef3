// SPDX-License-Identifier: GPL-3.0-or-later
// Linear statics on the same mesh by CalculiX (Dhondt and Wittig, www.calculix.de), where it is installed.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "sim/math/random.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/accuracy/support/settle.h"

namespace calot {
namespace {

constexpr double young = 5e3;
constexpr double poisson = 0.45;

/// Writes the body as CalculiX's four-node tetrahedra (C3D4) with forces on its nodes and one linear static step.
void writeJob(const std::filesystem::path& file, const test::KuhnBox& box, const std::vector<bool>& fixed,
              const std::vector<Vec3>& load) {
  std::ofstream out(file);
  out.precision(12);  // it reads twenty characters of a number
  out << "*NODE, NSET=NALL\n";
  for (std::size_t n = 0; n < box.node.size(); ++n) {
    out << n + 1 << ", " << box.node[n][0] << ", " << box.node[n][1] << ", " << box.node[n][2] << "\n";
  }
  out << "*ELEMENT, TYPE=C3D4, ELSET=EALL\n";
  for (std::size_t e = 0; e < box.tetrahedron.size(); ++e) {
    const Index4& t = box.tetrahedron[e];
    out << e + 1 << ", " << t[0] + 1 << ", " << t[1] + 1 << ", " << t[2] + 1 << ", " << t[3] + 1 << "\n";
  }
  out << "*BOUNDARY\n";
  for (std::size_t n = 0; n < fixed.size(); ++n) {
    if (fixed[n]) out << n + 1 << ", 1, 3\n";
  }
  out << "*MATERIAL, NAME=TISSUE\n*ELASTIC\n" << young << ", " << poisson << "\n";
  out << "*SOLID SECTION, ELSET=EALL, MATERIAL=TISSUE\n*STEP\n*STATIC\n*CLOAD\n";
  for (std::size_t n = 0; n < load.size(); ++n) {
    for (int i = 0; i < 3 && !fixed[n]; ++i) out << n + 1 << ", " << i + 1 << ", " << load[n][i] << "\n";
  }
  out << "*NODE PRINT, NSET=NALL\nU\n*END STEP\n";
}

/// Displacements by node from CalculiX's printed results: lines of four numbers, the first a node.
std::vector<Vec3> readDisplacements(const std::filesystem::path& file, std::size_t nodes) {
  std::vector<Vec3> moved(nodes, Vec3::Zero());
  std::size_t found = 0;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::size_t node = 0;
    Vec3 u;
    if (words >> node >> u[0] >> u[1] >> u[2] && node >= 1 && node <= nodes) {
      moved[node - 1] = u;
      ++found;
    }
  }
  EXPECT_EQ(found, nodes) << file;
  return moved;
}

TEST(CalculiX, SmallLoadsMoveEveryNodeAsTheLinearModel) {
  if (std::system("command -v ccx >/dev/null 2>&1") != 0) GTEST_SKIP() << "ccx (Debian: calculix-ccx) is not installed";
  SCOPED_TRACE("seed 31");
  Random random(31);
  test::KuhnBox box = test::kuhnBox(10, 5, 5, Vec3::Zero(), Vec3(0.15, 0.075, 0.075));
  for (int k = 1; k < box.nz; ++k) {
    for (int j = 1; j < box.ny; ++j) {
      for (int i = 1; i < box.nx; ++i) {
        for (int a = 0; a < 3; ++a) {
          box.node[static_cast<std::size_t>(box.index(i, j, k))][a] += 0.15 * 0.015 * (2.0 * random.uniform() - 1.0);
        }
      }
    }
  }
  const std::vector<bool> fixed = box.firstFace();
  std::vector<Vec3> load;
  for (std::size_t n = 0; n < box.node.size(); ++n) {
    const double x = random.normal();
    const double y = random.normal();
    const double z = random.normal();
    load.push_back(1e-7 * Vec3(x, y - 0.5, z));
  }

  std::string pattern = (std::filesystem::temp_directory_path() / "calot-ccx-XXXXXX").string();
  ASSERT_NE(mkdtemp(pattern.data()), nullptr);
  const std::filesystem::path folder = pattern;
  writeJob(folder / "box.inp", box, fixed, load);
  const int status = std::system(("cd '" + folder.string() + "' && ccx -i box >box.log 2>&1").c_str());
  EXPECT_EQ(status, 0);
  const std::vector<Vec3> theirs = readDisplacements(folder / "box.dat", box.node.size());
  std::filesystem::remove_all(folder);

  const SolidModel model(box.node, box.tetrahedron, fixed, {lameConstants(young, poisson), 1000.0, 0.0, 0.0});
  SolidState state = restState(model);
  ASSERT_LT(test::settle(model, state, {Vec3::Zero(), load, {}, 1.0, 3000, 1e-14}), 1e-14);
  double largest = 0.0;
  double worst = 0.0;
  for (std::size_t n = 0; n < box.node.size(); ++n) {
    largest = std::max(largest, theirs[n].norm());
    worst = std::max(worst, (state.position[n] - box.node[n] - theirs[n]).norm());
  }
  std::printf("%zu nodes: largest displacement %.3e m, largest difference %.1e of it\n", box.node.size(), largest,
              worst / largest);
  ASSERT_GT(largest, 1e-8);
  // Six digits are printed; rotations, which the linear model has not, enter at the square of the strain.
  EXPECT_LT(worst, 5e-6 * largest);
}

}  // namespace
}  // namespace calot
