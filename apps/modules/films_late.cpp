// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/tables.h"

namespace calot::gui {

std::unique_ptr<FilmWriter> openFilm(const std::filesystem::path& file, int width, int height, int fps) {
  return apps::module<apps::FilmModule>().open(file, width, height, fps);
}

void copyCleanFilm(const std::filesystem::path& film, const std::filesystem::path& output) {
  apps::module<apps::FilmModule>().copyClean(film, output);
}

}  // namespace calot::gui
