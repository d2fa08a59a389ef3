// SPDX-License-Identifier: GPL-3.0-or-later
// A figure as shapes, drawn identically in pages (SVG) and on paper.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace calot::analytics {

/// Role of a shape; styleOf() gives its style.
enum class Ink : std::uint8_t {
  heading,
  tick,
  axis,
  group,
  label,
  count,
  grid,
  whisker,
  median,
  cut,
  firstBox,
  secondBox,
  firstPoint,
  secondPoint,
  firstLine,
  secondLine,
  thirdLine,
  hollowPoint,
  band,  ///< around a curve
  low3,  ///< a score far below the middle of its scale, of seven steps
  low2,
  low1,
  middle,
  high1,
  high2,
  high3,
  watermark,
};

/// Anchor of a text's position: its beginning, its middle, its end.
enum class Anchor : std::uint8_t { start, middle, end };

struct InkStyle {
  const char* name;    ///< classes in a page, apart by a blank
  const char* stroke;  ///< "#rrggbb"; empty: no outline
  double strokeWidth;  ///< in the drawing's units
  bool dashed;
  const char* fill;    ///< "#rrggbb"; empty: none
  double fillOpacity;  ///< 0 to 1
  double letters;      ///< height of the font in the drawing's units; 0: no text
  bool bold;
  Anchor anchor;
};
const InkStyle& styleOf(Ink ink);
inline constexpr double dashOn = 5.0, dashOff = 3.0;  ///< of dashed lines, in the drawing's units

// x to the right, y down, in the drawing's units.
struct DrawnLine {
  double x1, y1, x2, y2;
};
struct DrawnBox {
  double x, y, width, height;  ///< x, y: the upper left corner
};
struct DrawnPoint {
  double x, y, radius;
};
struct DrawnText {
  double x, y;  ///< of the anchor, on the line that letters stand on
  std::string text;
  double degrees = 0.0;  ///< clockwise about the anchor
};

/// A place of a drawing that stands for an attempt or a participant: a window shows its text and opens it.
struct DrawnMark {
  double x, y;
  std::string key, text;  ///< uuid or pseudonym; what the mark is, in words
};

struct Shape {
  Ink ink;
  std::variant<DrawnLine, DrawnBox, DrawnPoint, DrawnText> form;
};

struct Drawing {
  std::string title;  ///< alternative text
  double width = 0.0, height = 0.0;
  std::vector<Shape> shapes;  ///< later ones over earlier ones
  std::vector<DrawnMark> marks = {};

  void line(Ink ink, double x1, double y1, double x2, double y2);
  void box(Ink ink, double x, double y, double boxWidth, double boxHeight);
  void point(Ink ink, double x, double y, double radius);
  void text(Ink ink, double x, double y, std::string words, double degrees = 0.0);
};

/// An `svg` element; every text escaped, two decimals.
std::string svgOf(const Drawing& drawing);
/// The rules for the classes of svgOf(), for a page's `style`.
std::string drawingCss();

}  // namespace calot::analytics
