// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/overlay.h"

#include <fmt/format.h>
#include <ft2build.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <string_view>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/checkpoints/phases.h"
#include "analytics/report/figure_number.h"
#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/recording/layout.h"
#include FT_FREETYPE_H

namespace calot::gui {
namespace {

const char* const fontFile = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";  // where Debian puts it

/// Characters of UTF-8; an invalid byte becomes a question mark.
std::vector<char32_t> charactersOf(const std::string& text) {
  std::vector<char32_t> characters;
  for (std::size_t i = 0; i < text.size();) {
    const auto first = static_cast<unsigned char>(text[i]);
    const std::size_t more = first < 0x80 ? 0 : first < 0xC0 ? 9 : first < 0xE0 ? 1 : first < 0xF0 ? 2 : 3;
    if (more == 9 || i + more >= text.size()) {
      characters.push_back(U'?');
      ++i;
      continue;
    }
    auto character = static_cast<char32_t>(more == 0 ? first : first & (0x3FU >> more));
    for (std::size_t k = 1; k <= more; ++k)
      character = (character << 6U) | (static_cast<unsigned char>(text[i + k]) & 0x3FU);
    characters.push_back(character);
    i += more + 1;
  }
  return characters;
}

struct Glyph {
  int left = 0, top = 0, width = 0, rows = 0, advance = 0;  // pixels; top above the base line
  std::vector<std::uint8_t> coverage;
};

}  // namespace

struct Lettering::Impl {
  FT_Library library = nullptr;
  FT_Face face = nullptr;
  int height = 0, ascent = 0;
  std::map<char32_t, Glyph> glyphs;

  ~Impl() {
    if (face != nullptr) FT_Done_Face(face);
    if (library != nullptr) FT_Done_FreeType(library);
  }

  const Glyph& glyph(char32_t character) {
    const auto found = glyphs.find(character);
    if (found != glyphs.end()) return found->second;
    Glyph glyph;
    if (FT_Load_Char(face, character, FT_LOAD_RENDER) == 0) {
      const FT_GlyphSlot slot = face->glyph;
      glyph = {slot->bitmap_left,
               slot->bitmap_top,
               static_cast<int>(slot->bitmap.width),
               static_cast<int>(slot->bitmap.rows),
               static_cast<int>((slot->advance.x + 32) / 64),
               {}};
      for (int y = 0; y < glyph.rows; ++y) {
        const unsigned char* const row = slot->bitmap.buffer + static_cast<std::ptrdiff_t>(y) * slot->bitmap.pitch;
        glyph.coverage.insert(glyph.coverage.end(), row, row + glyph.width);
      }
    }
    return glyphs.emplace(character, std::move(glyph)).first->second;
  }
};

Lettering::Lettering(int pixels) : impl_(std::make_unique<Impl>()) {
  const bool ready = FT_Init_FreeType(&impl_->library) == 0 &&
                     FT_New_Face(impl_->library, fontFile, 0, &impl_->face) == 0 &&
                     FT_Set_Pixel_Sizes(impl_->face, 0, static_cast<FT_UInt>(std::max(pixels, 6))) == 0;
  if (!ready)
    throw Error(ErrorKind::failure, Where{std::string(fontFile)},
                "cannot be read; install the package fonts-dejavu-core");
  impl_->height = static_cast<int>((impl_->face->size->metrics.height + 63) / 64);
  impl_->ascent = static_cast<int>((impl_->face->size->metrics.ascender + 63) / 64);
}

Lettering::~Lettering() = default;

int Lettering::lineHeight() const { return impl_->height; }

int Lettering::widthOf(const std::string& text) const {
  int width = 0;
  for (const char32_t character : charactersOf(text)) width += impl_->glyph(character).advance;
  return width;
}

void Lettering::write(Image& image, const std::string& text, int x, int y, Anchor anchor, const Colour& colour,
                      double opacity) const {
  if (anchor != Anchor::left) x -= widthOf(text) / (anchor == Anchor::middle ? 2 : 1);
  const auto draw = [&](int dx, int dy, const Colour& ink, double strength) {
    int at = x + dx;
    for (const char32_t character : charactersOf(text)) {
      const Glyph& glyph = impl_->glyph(character);
      for (int row = 0; row < glyph.rows; ++row)
        for (int column = 0; column < glyph.width; ++column) {
          const std::size_t i =
              static_cast<std::size_t>(row) * static_cast<std::size_t>(glyph.width) + static_cast<std::size_t>(column);
          blend(image, at + glyph.left + column, y + dy + impl_->ascent - glyph.top + row, ink,
                strength * opacity * glyph.coverage[i] / 255.0);
        }
      at += glyph.advance;
    }
  };
  for (const auto& [dx, dy] : {std::pair(-1, 0), {1, 0}, {0, -1}, {0, 1}}) draw(dx, dy, {0, 0, 0}, 0.6);
  draw(0, 0, colour, 1.0);
}

namespace {

/// Checkpoints for a film: those that a viewer can follow.
constexpr std::array<std::string_view, 8> shownCheckpoints{
    "path-length",  "fat-remaining", "connective-remaining", "connective-torn",
    "organ-burned", "clip-errors",   "critical-errors",      "organ-perforations"};
constexpr double refreshSeconds = 1.0;  // updating more often costs time and is not readable

/// Every step's result is needed.
void refuseLean(const recorder::Recording& recording) {
  if (recorder::isMinimal(recording.header()))
    throw Error(ErrorKind::invalid, Where{recording.path().string()},
                "is a golden recording, which holds no results of its steps: overlays other than time, and alignment "
                "by phase, need one of `calot record`");
}

}  // namespace

MomentTrack::MomentTrack(const std::filesystem::path& recording, bool checkpoints) : recording_(recording) {
  refuseLean(recording_);
  const recorder::AttemptHeader& header = recording_.header();
  const SceneDescription scene = recorder::sceneFromAssets(header.assets).description;
  results_.emplace(header, scene);
  judge_.emplace(scene);
  stepSeconds_ = header.tickSeconds * header.ticksPerStep;
  names_ = analytics::subjectNames(scene);
  if (checkpoints)
    collector_ = std::make_unique<analytics::CheckpointCollector>(header, scene, analytics::Origin::observables);
}

void MomentTrack::add(const recorder::RecordedStep& step) {
  const double time = static_cast<double>(step.step + 1) * stepSeconds_;
  const StepResult& result = results_->of(step);
  for (const Told& told : tell(judge_->observe(result), names_))
    moment_.events.push_back({told.text, told.marked(), time});
  smoke_.add(time, step.result.events);
  for (std::size_t h = 0; h < handCount; ++h) {
    const HandResult& hand = step.result.hand[h];
    if (hand.instrument == InstrumentKind::none)
      moment_.path[h].clear();
    else
      moment_.path[h].push_back({hand.tipSimulated, time});
  }
  if (collector_) collector_->onStep({step.step, step.samples, step.ticks, result, step.digest, step.lateness, {}, {}});
}

void MomentTrack::refreshCheckpoints(double time) {
  if (!collector_ || (checkpointsAt_ >= 0.0 && time < checkpointsAt_ + refreshSeconds)) return;
  checkpointsAt_ = time;
  moment_.checkpoints.clear();
  const std::vector<analytics::CheckpointValue> values = collector_->values();
  for (const std::string_view name : shownCheckpoints) {
    const analytics::CheckpointDefinition* const definition = analytics::findCheckpoint(name);
    if (definition == nullptr) continue;
    for (const analytics::CheckpointValue& value : values) {
      if (value.name != name || !value.value) continue;
      const std::string number = analytics::figureNumber(definition, *value.value * definition->displayFactor, 3);
      const std::string unit = definition->displayUnit == "1" ? "" : " " + definition->displayUnit;
      moment_.checkpoints.push_back(
          fmt::format("{}{}{}  {}{}", name, value.subject.empty() ? "" : " ", value.subject, number, unit));
    }
  }
}

const Moment& MomentTrack::at(std::uint64_t n) {
  while (next_ <= n) add(recording_.step(next_++));
  moment_.time = static_cast<double>(next_) * stepSeconds_;
  moment_.phase = wordFor(judge_->judgement().phase);
  const auto forget = [&](auto& past, double seconds) {
    while (!past.empty() && past.front().time < moment_.time - seconds) past.pop_front();
  };
  forget(moment_.events, Moment::eventSeconds);
  for (auto& path : moment_.path) forget(path, Moment::pathSeconds);
  moment_.smoke = smoke_.at(moment_.time);
  refreshCheckpoints(moment_.time);
  return moment_;
}

std::array<double, 4> phaseStarts(const std::filesystem::path& path) {
  recorder::Recording recording(path);
  refuseLean(recording);
  const double stepSeconds = recording.header().tickSeconds * recording.header().ticksPerStep;
  recorder::RecordedJudge judge(recording.header());
  std::array<double, 4> starts{-1.0, -1.0, -1.0, -1.0};
  for (std::uint64_t n = 0; n < recording.stepCount(); ++n) {
    const Phase phase = judge.observe(recording.step(n)).phase;
    for (std::size_t p = 0; p < starts.size(); ++p)
      if (analytics::windowPhases[p] == phase && starts[p] < 0.0) starts[p] = static_cast<double>(n) * stepSeconds;
  }
  return starts;
}

namespace {

constexpr Colour white{245, 245, 245}, amber{255, 190, 70}, grey{190, 190, 190};
constexpr std::array<Colour, handCount> handColour{Colour{90, 200, 255}, Colour{255, 170, 60}};  // blue and orange

constexpr std::array<std::pair<std::string_view, bool Overlays::*>, 5> overlayWords{{
    {"time", &Overlays::time},
    {"phase", &Overlays::phase},
    {"checkpoints", &Overlays::checkpoints},
    {"events", &Overlays::events},
    {"tools", &Overlays::tools},
}};

/// A dot with a soft edge.
void dot(Image& image, double x, double y, double radius, const Colour& colour, double opacity) {
  for (int py = static_cast<int>(std::floor(y - radius)); py <= static_cast<int>(std::ceil(y + radius)); ++py)
    for (int px = static_cast<int>(std::floor(x - radius)); px <= static_cast<int>(std::ceil(x + radius)); ++px)
      blend(image, px, py, colour,
            opacity * std::clamp(radius + 0.5 - std::hypot(px + 0.5 - x, py + 0.5 - y), 0.0, 1.0));
}

void drawPaths(Image& image, const Moment& moment, const SceneView& view) {
  const Mat3 toCamera = view.camera.orientation.normalized().conjugate().toRotationMatrix();
  const double focal = 0.5 * image.height / std::tan(0.5 * view.verticalFieldOfView);
  const double radius = std::max(1.0, image.height / 480.0);
  for (std::size_t h = 0; h < handCount; ++h) {
    bool drawn = false;
    double lastX = 0.0, lastY = 0.0;
    for (const Moment::Place& place : moment.path[h]) {
      const Vec3 p = toCamera * (place.p_W - view.camera.position);
      if (p.z() < 1e-3) {
        drawn = false;
        continue;
      }
      const double x = 0.5 * image.width + focal * p.x() / p.z(), y = 0.5 * image.height + focal * p.y() / p.z();
      const double away = drawn ? std::hypot(x - lastX, y - lastY) : 1e9;
      if (away < 1.0) continue;                                                         // at rest, dots would pile up
      const int steps = away < 200.0 ? static_cast<int>(std::ceil(away / radius)) : 1;  // else it jumped: one dot
      const double opacity = 0.55 * (1.0 - (moment.time - place.time) / Moment::pathSeconds);
      for (int i = 1; i <= steps; ++i) {
        const double share = static_cast<double>(i) / steps;
        const double fromX = steps > 1 ? lastX : x, fromY = steps > 1 ? lastY : y;
        dot(image, fromX + share * (x - fromX), fromY + share * (y - fromY), radius, handColour[h], opacity);
      }
      drawn = true;
      lastX = x;
      lastY = y;
    }
  }
}

}  // namespace

Overlays parseOverlays(const std::string& text) {
  Overlays overlays;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string_view word = std::string_view(text).substr(begin, end - begin);
    const auto* const known = std::find_if(overlayWords.begin(), overlayWords.end(),
                                           [&](const auto& overlay) { return overlay.first == word; });
    if (known == overlayWords.end())
      throw Error(ErrorKind::invalid,
                  fmt::format("there is no overlay '{}'; there are time, phase, checkpoints, events, tools", word));
    overlays.*known->second = true;
    begin = end + 1;
  }
  return overlays;
}

OverlayPainter::OverlayPainter(int pictureHeight) : letters_(pictureHeight / 36), margin_(pictureHeight / 45) {}

void OverlayPainter::paintTitle(Image& image, std::string title) const {
  const int besideIt = 2 * (letters_.widthOf("00:00.0") + 2 * margin_);  // the time, and as much on the right
  if (letters_.widthOf(title) > image.width - besideIt) {
    while (!title.empty() && letters_.widthOf(title + "…") > image.width - besideIt) {
      while (title.size() > 1 && (static_cast<unsigned char>(title.back()) & 0xC0U) == 0x80U) title.pop_back();
      title.pop_back();
    }
    title += "…";
  }
  letters_.write(image, title, image.width / 2, margin_, Anchor::middle, white);
}

/// In lines that fit, broken at spaces: whatever the size of the picture, none of it is left out.
void OverlayPainter::paintDoubt(Image& image, const std::string& doubt) const {
  int y = image.height / 4;
  std::string line;
  const auto write = [&] {
    letters_.write(image, line, image.width / 2, y, Anchor::middle, amber);
    y += letters_.lineHeight();
  };
  for (std::size_t at = 0; at < doubt.size();) {
    const std::size_t end = std::min(doubt.find(' ', at), doubt.size());
    const std::string longer = line + (line.empty() ? "" : " ") + doubt.substr(at, end - at);
    if (!line.empty() && letters_.widthOf(longer) > image.width - 2 * margin_) {
      write();
      line = doubt.substr(at, end - at);
    } else {
      line = longer;
    }
    at = end + 1;
  }
  write();
}

void OverlayPainter::paintEvents(Image& image, const Moment& moment, int bottom) const {
  int y = bottom;
  for (auto line = moment.events.rbegin(); line != moment.events.rend(); ++line) {
    y -= letters_.lineHeight();
    if (y < image.height / 2) break;
    const double fading = std::clamp(Moment::eventSeconds - (moment.time - line->time), 0.0, 1.0);
    letters_.write(image, line->text, margin_, y, Anchor::left, line->fault ? amber : white, fading);
  }
}

void OverlayPainter::paint(Image& image, const Overlays& overlays, const Moment& moment, const SceneView& view,
                           const Captions& captions) const {
  const int bottom = image.height - margin_;
  if (overlays.tools) drawPaths(image, moment, view);
  int y = margin_;
  if (overlays.time) {
    letters_.write(image, timeText(moment.time), margin_, y, Anchor::left, white);
    y += letters_.lineHeight();
  }
  if (overlays.phase && !moment.phase.empty()) letters_.write(image, moment.phase, margin_, y, Anchor::left, white);
  if (overlays.checkpoints) {
    y = margin_ + (captions.title.empty() ? 0 : letters_.lineHeight());
    for (const std::string& line : moment.checkpoints) {
      letters_.write(image, line, image.width - margin_, y, Anchor::right, grey);
      y += letters_.lineHeight();
    }
  }
  const bool narrow = 3 * letters_.widthOf(captions.mark) > image.width;
  if (overlays.events) paintEvents(image, moment, bottom - (narrow ? letters_.lineHeight() : 0));
  if (!captions.mark.empty())
    letters_.write(image, captions.mark, image.width - margin_, bottom - letters_.lineHeight(), Anchor::right, grey,
                   0.85);
  if (!captions.title.empty()) paintTitle(image, captions.title);
  if (!captions.doubt.empty()) paintDoubt(image, captions.doubt);
}

}  // namespace calot::gui
