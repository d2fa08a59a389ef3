// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/lettering.h"

#include <ft2build.h>
#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "recorder/base/errors.h"
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

}  // namespace calot::gui
