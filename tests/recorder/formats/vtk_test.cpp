// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/formats/mesh_file.h"

#include <gtest/gtest.h>

#include <sstream>
#include <string>

namespace calot::recorder {
namespace {

TEST(Vtk, IsTheLegacyFormatAndReadsBackExactly) {
  TetrahedralMesh mesh;
  mesh.vertex = {Vec3(0.1, 1.0 / 3.0, -0.0), Vec3(1e-17, 2.5, 3.0), Vec3(0.0, 1.0, 5e-324), Vec3(7.0, 1e300, 0.2)};
  mesh.tetrahedron = {Index4(0, 1, 2, 3), Index4(3, 2, 1, 0)};
  std::istringstream in(formatVtk(mesh, "two\nlines"));
  std::string line;
  for (const char* wanted :
       {"# vtk DataFile Version 3.0", "two lines", "ASCII", "DATASET UNSTRUCTURED_GRID", "POINTS 4 double"}) {
    ASSERT_TRUE(std::getline(in, line));
    EXPECT_EQ(line, wanted);
  }
  for (const Vec3& p : mesh.vertex) {
    for (int k = 0; k < 3; ++k) {
      std::string word;
      in >> word;
      EXPECT_EQ(std::strtod(word.c_str(), nullptr), p[k]);
    }
  }
  std::string word;
  int cells = 0;
  int numbers = 0;
  in >> word >> cells >> numbers;
  EXPECT_EQ(word, "CELLS");
  EXPECT_EQ(cells, 2);
  EXPECT_EQ(numbers, 10);
  for (const Index4& v : mesh.tetrahedron) {
    int n = 0;
    in >> n;
    EXPECT_EQ(n, 4);
    for (int k = 0; k < 4; ++k) {
      in >> n;
      EXPECT_EQ(n, v[k]);
    }
  }
  in >> word >> cells;
  EXPECT_EQ(word, "CELL_TYPES");
  EXPECT_EQ(cells, 2);
  int type = 0;
  while (in >> type) EXPECT_EQ(type, 10);
}

TEST(Vtk, TitleIsCutToWhatTheFormatAllows) {
  const std::string text = formatVtk({}, std::string(1000, 'x'));
  EXPECT_NE(text.find("\n" + std::string(255, 'x') + "\nASCII\n"), std::string::npos);
}

}  // namespace
}  // namespace calot::recorder
