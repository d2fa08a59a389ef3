// SPDX-License-Identifier: GPL-3.0-or-later
// The sheets to print: two handles and the board. Lengths are millimetres on paper, from the upper left corner.
#pragma once

#include <string>
#include <vector>

#include "recorder/sources/devices/camera/handle_geometry.h"

namespace calot::recorder {

struct SheetTag {
  int id = 0;
  double left = 0.0, top = 0.0;  ///< of the black square
  double side = 0.0;
};
struct SheetLine {
  enum class Kind : std::uint8_t { cut, fold, ruler };
  double x1 = 0.0, y1 = 0.0, x2 = 0.0, y2 = 0.0;
  Kind kind = Kind::cut;
};
struct SheetText {
  double x = 0.0, y = 0.0;  ///< begin of the base line
  double size = 3.2;        ///< height of the letters
  std::string text;
};

struct MarkerSheet {
  double width = 210.0, height = 297.0;  ///< A4, upright or across
  std::vector<SheetTag> tags;
  std::vector<SheetLine> lines;
  std::vector<SheetText> texts;
};

inline constexpr double rulerLength = 100.0;

/// Left handle, right handle, board.
std::vector<MarkerSheet> markerSheets();

}  // namespace calot::recorder
