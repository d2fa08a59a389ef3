// SPDX-License-Identifier: GPL-3.0-or-later
// The sheets to print: two handles and the board. Lengths are millimetres on paper, from the upper left corner.
// Where the tags of the printed handles and of the printed board lie (AprilTag family 36h11).
//
// A handle is a sleeve of paper, a square prism around a stick. Its frame I: origin in the sleeve's middle, z along the
// stick towards the tip, x out of face 0, y out of face 1. Each face carries two tags, the end away from the tip one,
// and a flap that a finger lifts, hinged on face 0's lower edge, one: its angle is the jaw's.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

inline constexpr double tagSide = 0.028;   ///< of the black square (m)
inline constexpr double tagPitch = 0.036;  ///< from tag to tag, and the width of a face (m)
inline constexpr int boardColumns = 7, boardRows = 5;
inline constexpr int capTag = 8, flapTag = 9;  ///< within a handle
inline constexpr double flapGap = 0.020;       ///< from the hinge to the middle of the flap's tag (m)

/// A tag in some frame: its middle, and the directions right and down on paper (unit).
struct TagPlace {
  int id = 0;
  Vec3 middle = Vec3::Zero(), right = Vec3::UnitX(), down = Vec3::UnitY();

  /// Corner k in the detector's order: lower left, lower right, upper right, upper left.
  [[nodiscard]] Vec3 corner(int k, double side = tagSide) const;
  /// Out of the paper, towards who sees it.
  [[nodiscard]] Vec3 normal() const { return down.cross(right); }
};

/// Number of the first tag of a hand's handle.
int firstTagOf(Hand hand);
inline constexpr int firstBoardTag = 100;

/// The rigid tags of a handle in I: eight of the faces, then the cap. @param scale print scale
std::vector<TagPlace> handleTags(Hand hand, double scale = 1.0);

/// The flap's tag at an angle of the jaw (rad, 0: flat along the stick).
TagPlace flapAt(Hand hand, double angle, double scale = 1.0);

/// The board's tags: plane z = 0, x right, y down, origin in its middle.
std::vector<TagPlace> boardTags(double scale = 1.0);

/// Black (true) and white cells of a tag with its white margin, 10 rows of 10 from the upper left.
std::array<bool, 100> tagCells(int id);

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
