// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures to a film file, by libav.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "gui/render/image.h"

namespace calot::gui {

/// Encodes pictures of one size at a fixed rate: H.264 (libx264) in MP4 or Matroska, or VP9 where this libav has no
/// H.264. Picture k is shown at exactly k / fps seconds. No date is written; even so, bytes may differ from run to
/// run, as libx264's do.
///
/// The file appears under its name when it is whole: until finish() it is written beside it under a temporary name, and
/// is removed if finish() is never reached.
class FilmWriter {
 public:
  FilmWriter() = default;
  virtual ~FilmWriter() = default;
  FilmWriter(const FilmWriter&) = delete;
  FilmWriter& operator=(const FilmWriter&) = delete;

  /// Checks the arguments of openFilm(). @param file ends with .mp4 or .mkv @param fps pictures a second, 1 to 120
  /// @throws calot::Error (invalid) for another ending, an odd width or height (colour is stored for two by two pixels)
  /// or a rate out of range
  static void check(const std::filesystem::path& file, int width, int height, int fps);

  /// Appends a frame; its alpha is ignored. @pre of the film's size @throws calot::Error (failure)
  virtual void add(const Image& image) = 0;
  /// Writes pending frames and renames the file to its final name. @throws calot::Error (failure)
  virtual void finish() = 0;

  [[nodiscard]] virtual std::int64_t pictures() const = 0;
};

/// @pre FilmWriter::check() accepts them
/// @throws calot::Error (failure) where libav has no encoder or the file cannot be written
std::unique_ptr<FilmWriter> openFilm(const std::filesystem::path& file, int width, int height, int fps);

/// Copies a film's pictures as they are encoded into a new MP4 file, and nothing else: no title, date, place, name of a
/// device or program, no chapters, and no sound, in which people may be named.
/// @param output does not exist
/// @throws calot::Error: damaged where the film cannot be read or its pictures cannot be in MP4; failure where the file
/// cannot be written. Nothing is left behind then.
void copyCleanFilm(const std::filesystem::path& film, const std::filesystem::path& output);

}  // namespace calot::gui
