// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/looks.h"

#include <algorithm>

namespace calot::gui {

namespace {

constexpr int sheetLook = -1, smokeLook = -2, readyLook = -3;

int lookOf(const DrawPart& part) { return 2 * static_cast<int>(part.appearance) + (part.harmed ? 1 : 0); }

bool isTissue(Appearance a) { return a < Appearance::insulation && !isSurroundings(a); }

}  // namespace

bool LooksDrawn::note(const DrawList& list, const RenderSettings& settings) {
  bool isNew = false;
  const auto add = [&](int look) { isNew = drawn_.insert({settings.quality, look}).second || isNew; };
  for (const DrawPart& part : list.part) add(lookOf(part));
  if (!list.sheets.index.empty()) add(sheetLook);
  if (!list.smoke.index.empty()) add(smokeLook);
  if (settings.ready) add(readyLook);
  return isNew;
}

std::vector<DrawPart> looksToCome(const DrawList& list) {
  std::vector<DrawPart> parts;
  const auto add = [&](Appearance appearance, bool harmed) {
    DrawPart part = list.part.front();
    part.indexCount = 3;
    part.appearance = appearance;
    part.harmed = harmed;
    const auto same = [&](const DrawPart& other) { return lookOf(other) == lookOf(part); };
    if (std::none_of(parts.begin(), parts.end(), same) && std::none_of(list.part.begin(), list.part.end(), same))
      parts.push_back(part);
  };
  bool vessels = false;
  for (const DrawPart& part : list.part) {
    if (isTissue(part.appearance)) add(part.appearance, true);
    vessels = vessels || part.appearance == Appearance::duct || part.appearance == Appearance::artery;
  }
  for (const Appearance a : {Appearance::insulation, Appearance::steel, Appearance::ceramic}) add(a, false);
  if (vessels)
    for (const Appearance a :
         {Appearance::titanium, Appearance::blood, Appearance::bile, Appearance::omentum, Appearance::bowel})
      add(a, false);
  return parts;
}

}  // namespace calot::gui
