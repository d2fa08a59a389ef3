// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/marker_sheets.h"

#include <fmt/format.h>
#include <cassert>
#include <string_view>

#include "sim/math/elementary.h"

namespace calot::recorder {

Vec3 TagPlace::corner(int k, double side) const {
  const double along = (k == 1 || k == 2) ? 0.5 : -0.5;
  const double across = k < 2 ? 0.5 : -0.5;
  return middle + side * (along * right + across * down);
}

int firstTagOf(Hand hand) { return hand == Hand::left ? 0 : 20; }

std::vector<TagPlace> handleTags(Hand hand, double scale) {
  const std::array<Vec3, 4> normals{Vec3::UnitX(), Vec3::UnitY(), -Vec3::UnitX(), -Vec3::UnitY()};
  const double half = 0.5 * tagPitch * scale;
  std::vector<TagPlace> out;
  for (std::size_t face = 0; face < normals.size(); ++face) {
    for (int row = 0; row < 2; ++row) {
      const Vec3 middle = half * normals[face] + (row == 0 ? -half : half) * Vec3::UnitZ();
      out.push_back({firstTagOf(hand) + 2 * static_cast<int>(face) + row, middle, normals[face].cross(Vec3::UnitZ()),
                     Vec3::UnitZ()});
    }
  }
  out.push_back({firstTagOf(hand) + capTag, -2.0 * half * Vec3::UnitZ(), -Vec3::UnitY(), Vec3::UnitX()});
  return out;
}

TagPlace flapAt(Hand hand, double angle, double scale) {
  const double half = 0.5 * tagPitch * scale;
  const Vec3 hinge(half, 0.0, 2.0 * half);
  const Vec3 down(sine(angle), 0.0, cosine(angle));
  return {firstTagOf(hand) + flapTag, hinge + flapGap * scale * down, -Vec3::UnitY(), down};
}

std::vector<TagPlace> boardTags(double scale) {
  std::vector<TagPlace> out;
  for (int row = 0; row < boardRows; ++row) {
    for (int column = 0; column < boardColumns; ++column) {
      const Vec3 middle(column - 0.5 * (boardColumns - 1), row - 0.5 * (boardRows - 1), 0.0);
      out.push_back({firstBoardTag + row * boardColumns + column, tagPitch * scale * middle});
    }
  }
  return out;
}

namespace {

constexpr double perMetre = 1000.0;
constexpr double pitch = perMetre * tagPitch, side = perMetre * tagSide;

void addTag(MarkerSheet& sheet, int id, double middleX, double middleY) {
  sheet.tags.push_back({id, middleX - 0.5 * side, middleY - 0.5 * side, side});
}

void addText(MarkerSheet& sheet, double x, double y, double size, std::string_view text) {
  SheetText& out = sheet.texts.emplace_back();
  out.x = x;
  out.y = y;
  out.size = size;
  out.text.assign(text);
}

void addRuler(MarkerSheet& sheet, double left, double y) {
  const auto kind = SheetLine::Kind::ruler;
  sheet.lines.push_back({left, y, left + rulerLength, y, kind});
  for (int i = 0; i <= 10; ++i) {
    const double x = left + 0.1 * rulerLength * i;
    sheet.lines.push_back({x, y, x, y - (i % 5 == 0 ? 5.0 : 3.0), kind});
  }
  addText(sheet, left, y + 5.0, 3.2,
          "100 mm. Print at 100 %, not \"fit to page\"; if it measures otherwise, tell the calibration");
}

MarkerSheet handleSheet(Hand hand) {
  // Faces side by side as their paper lies flat, seen from outside: what lies right of face 0 is face 3.
  constexpr double left = 28.0, top = 80.0;
  constexpr std::array<int, 4> faces{0, 3, 2, 1};
  constexpr double tab = 10.0;
  const int first = firstTagOf(hand);
  const double bottom = top + 2.0 * pitch, right = left + 4.0 * pitch,
               flapEnd = bottom + perMetre * flapGap + 0.5 * pitch;
  MarkerSheet sheet;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const double x = left + pitch * (static_cast<double>(i) + 0.5);
    for (int row = 0; row < 2; ++row) addTag(sheet, first + 2 * faces[i] + row, x, top + pitch * (row + 0.5));
  }
  addTag(sheet, first + capTag, left + 0.5 * pitch, top - 0.5 * pitch);
  addTag(sheet, first + flapTag, left + 0.5 * pitch, bottom + perMetre * flapGap);
  const auto line = [&](double x1, double y1, double x2, double y2, SheetLine::Kind kind) {
    sheet.lines.push_back({x1, y1, x2, y2, kind});
  };
  const auto fold = SheetLine::Kind::fold, cut = SheetLine::Kind::cut;
  for (int i = 1; i <= 4; ++i) line(left + pitch * i, top, left + pitch * i, bottom, fold);
  line(left, top, left + pitch, top, fold);
  line(left, bottom, left + pitch, bottom, fold);
  // Outline, clockwise from the cap: a tab glues it on each side, one closes the sleeve.
  line(left, top, left, top - pitch, cut);
  line(left, top - pitch, left + pitch, top - pitch, fold);
  line(left, top - pitch, left + 4.0, top - pitch - tab, cut);
  line(left + 4.0, top - pitch - tab, left + pitch - 4.0, top - pitch - tab, cut);
  line(left + pitch - 4.0, top - pitch - tab, left + pitch, top - pitch, cut);
  line(left + pitch, top - pitch, left + pitch, top, cut);
  line(left + pitch, top, right, top, cut);
  line(right, top, right + tab, top + 4.0, cut);
  line(right + tab, top + 4.0, right + tab, bottom - 4.0, cut);
  line(right + tab, bottom - 4.0, right, bottom, cut);
  line(right, bottom, left + pitch, bottom, cut);
  line(left + pitch, bottom, left + pitch, flapEnd, cut);
  line(left + pitch, flapEnd, left, flapEnd, cut);
  line(left, flapEnd, left, bottom, cut);
  line(left, bottom, left, top, cut);
  addText(sheet, left, 18.0, 5.0, fmt::format("Calot: handle of the {} hand", hand == Hand::left ? "LEFT" : "RIGHT"));
  double y = bottom + 55.0;
  for (const char* text :
       {"1. Print on stiff matt paper at 100 % and check the ruler.",
        "2. Cut along the full lines, fold along the dashed ones, print outwards.",
        "3. Glue the sleeve around a stick of 36 mm square section, or a core that fills it.",
        "    Close the end with the cap.",
        "4. The end without a cap points to the tip. The flap below the first face stays loose: a finger lifts it, and",
        "    its angle opens the jaw. Tape its back, so that it stays flat."}) {
    addText(sheet, left, y, 3.2, text);
    y += 6.0;
  }
  addRuler(sheet, left, y + 12.0);
  return sheet;
}

MarkerSheet boardSheet() {
  MarkerSheet sheet;
  sheet.width = 297.0;
  sheet.height = 210.0;
  for (const TagPlace& tag : boardTags())
    addTag(sheet, tag.id, 0.5 * sheet.width + perMetre * tag.middle.x(), 97.0 + perMetre * tag.middle.y());
  addText(sheet, 160.0, 197.0, 3.2, "Calot: board for the lens. Glue it flat on glass or board.");
  addRuler(sheet, 22.5, 197.0);
  return sheet;
}

}  // namespace

std::vector<MarkerSheet> markerSheets() { return {handleSheet(Hand::left), handleSheet(Hand::right), boardSheet()}; }

}  // namespace calot::recorder
