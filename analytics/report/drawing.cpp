// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "analytics/report/report_document.h"

namespace calot::analytics {
namespace {

constexpr const char *grey = "#57606a", *black = "#1b1f24", *red = "#b00020", *blue = "#0b5a8a", *brown = "#a3530b";

// In Ink's order. Scores run from brown over grey to blue, which is safe for colour-blind readers.
constexpr std::array<InkStyle, static_cast<std::size_t>(Ink::watermark) + 1> styles{{
    {"heading", "", 0.0, false, black, 1.0, 12.0, true, Anchor::start},
    {"tick", "", 0.0, false, black, 1.0, 10.0, false, Anchor::end},
    {"axis", "", 0.0, false, black, 1.0, 11.0, false, Anchor::middle},
    {"group", "", 0.0, false, black, 1.0, 11.0, false, Anchor::middle},
    {"label", "", 0.0, false, black, 1.0, 11.0, false, Anchor::start},
    {"count", "", 0.0, false, black, 1.0, 10.0, false, Anchor::middle},
    {"grid", "#e3e7eb", 1.0, false, "", 1.0, 0.0, false, Anchor::start},
    {"whisker", grey, 1.0, false, "", 1.0, 0.0, false, Anchor::start},
    {"median", black, 2.5, false, "", 1.0, 0.0, false, Anchor::start},
    {"cut", red, 1.0, true, "", 1.0, 0.0, false, Anchor::start},
    {"box first", grey, 1.0, false, "#b8d8ec", 1.0, 0.0, false, Anchor::start},
    {"box second", grey, 1.0, false, "#f6d3a8", 1.0, 0.0, false, Anchor::start},
    {"point first", "", 0.0, false, blue, 0.75, 0.0, false, Anchor::start},
    {"point second", "", 0.0, false, brown, 0.75, 0.0, false, Anchor::start},
    {"line first", blue, 1.5, false, "", 1.0, 0.0, false, Anchor::start},
    {"line second", brown, 1.5, false, "", 1.0, 0.0, false, Anchor::start},
    {"line third", grey, 1.5, false, "", 1.0, 0.0, false, Anchor::start},
    {"point hollow", brown, 1.5, false, "#ffffff", 1.0, 0.0, false, Anchor::start},
    {"band", "", 0.0, false, "#d6e8f3", 1.0, 0.0, false, Anchor::start},
    {"score low3", "#ffffff", 0.5, false, "#c9702b", 1.0, 0.0, false, Anchor::start},
    {"score low2", "#ffffff", 0.5, false, "#e5a366", 1.0, 0.0, false, Anchor::start},
    {"score low1", "#ffffff", 0.5, false, "#f6d3a8", 1.0, 0.0, false, Anchor::start},
    {"score middle", "#ffffff", 0.5, false, "#e3e7eb", 1.0, 0.0, false, Anchor::start},
    {"score high1", "#ffffff", 0.5, false, "#b8d8ec", 1.0, 0.0, false, Anchor::start},
    {"score high2", "#ffffff", 0.5, false, "#74b0d6", 1.0, 0.0, false, Anchor::start},
    {"score high3", "#ffffff", 0.5, false, "#3f87b5", 1.0, 0.0, false, Anchor::start},
    {"mark", "", 0.0, false, red, 0.16, 44.0, true, Anchor::middle},
}};

const char* wordFor(Anchor anchor) {
  return anchor == Anchor::start ? "start" : anchor == Anchor::middle ? "middle" : "end";
}

struct SvgElement {
  const char* kind;

  std::string operator()(const DrawnLine& l) const {
    return fmt::format("<line class=\"{}\" x1=\"{:.2f}\" y1=\"{:.2f}\" x2=\"{:.2f}\" y2=\"{:.2f}\"/>\n", kind, l.x1,
                       l.y1, l.x2, l.y2);
  }
  std::string operator()(const DrawnBox& b) const {
    return fmt::format("<rect class=\"{}\" x=\"{:.2f}\" y=\"{:.2f}\" width=\"{:.2f}\" height=\"{:.2f}\"/>\n", kind, b.x,
                       b.y, b.width, b.height);
  }
  std::string operator()(const DrawnPoint& p) const {
    return fmt::format("<circle class=\"{}\" cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"{:.2f}\"/>\n", kind, p.x, p.y, p.radius);
  }
  std::string operator()(const DrawnText& t) const {
    const std::string place =
        t.degrees == 0.0 ? fmt::format("x=\"{:.2f}\" y=\"{:.2f}\"", t.x, t.y)
                         : fmt::format("transform=\"translate({:.2f} {:.2f}) rotate({:.0f})\"", t.x, t.y, t.degrees);
    return fmt::format("<text class=\"{}\" {}>{}</text>\n", kind, place, escaped(t.text));
  }
};

/// The form of a new shape, made in place: a temporary's move, inlined, makes GCC 12 warn of its unused text.
auto& addShape(std::vector<Shape>& shapes, Ink ink) {
  Shape& shape = shapes.emplace_back();
  shape.ink = ink;
  return shape.form;
}

}  // namespace

const InkStyle& styleOf(Ink ink) { return styles.at(static_cast<std::size_t>(ink)); }

void Drawing::line(Ink ink, double x1, double y1, double x2, double y2) {
  addShape(shapes, ink).emplace<DrawnLine>(DrawnLine{x1, y1, x2, y2});
}
void Drawing::box(Ink ink, double x, double y, double boxWidth, double boxHeight) {
  addShape(shapes, ink).emplace<DrawnBox>(DrawnBox{x, y, boxWidth, boxHeight});
}
void Drawing::point(Ink ink, double x, double y, double radius) {
  addShape(shapes, ink).emplace<DrawnPoint>(DrawnPoint{x, y, radius});
}
void Drawing::text(Ink ink, double x, double y, std::string words, double degrees) {
  shapes.push_back({ink, DrawnText{x, y, std::move(words), degrees}});
}

std::string svgOf(const Drawing& drawing) {
  std::string svg =
      fmt::format("<svg viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\">\n<title>{2}</title>\n",
                  drawing.width, drawing.height, escaped(drawing.title));
  for (const Shape& shape : drawing.shapes) svg += std::visit(SvgElement{styleOf(shape.ink).name}, shape.form);
  return svg + "</svg>\n";
}

std::string drawingCss() {
  std::string css;
  for (const InkStyle& s : styles) {
    std::string selector = s.name;
    std::replace(selector.begin(), selector.end(), ' ', '.');
    css += fmt::format(".{} {{", selector);
    if (s.letters > 0.0)
      css += fmt::format(" font: {}{}px sans-serif; text-anchor: {};", s.bold ? "bold " : "", s.letters,
                         wordFor(s.anchor));
    if (*s.stroke != '\0') css += fmt::format(" stroke: {}; stroke-width: {};", s.stroke, s.strokeWidth);
    if (s.dashed) css += fmt::format(" stroke-dasharray: {} {};", dashOn, dashOff);
    if (*s.fill != '\0') css += fmt::format(" fill: {};", s.fill);
    if (s.fillOpacity < 1.0) css += fmt::format(" fill-opacity: {};", s.fillOpacity);
    css += " }\n";
  }
  return css;
}

}  // namespace calot::analytics
