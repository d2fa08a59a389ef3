// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of the modules (module.h).
#pragma once

#include "apps/modules/module.h"
#include "gui/film/film_writer.h"
#include "gui/report/pdf_report.h"
#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/camera/marker_sheets.h"
#include "recorder/sources/devices/force/haply_device.h"
#include "recorder/sources/devices/openigtlink_device.h"
#include "recorder/sources/devices/pointer_device.h"
#include "recorder/surfaces/surface_union.h"

namespace calot::apps {

struct FilmModule : Module {
  static constexpr const char* name = "films";
  decltype(&gui::openFilm) open;
  decltype(&gui::copyCleanFilm) copyClean;
};

struct PdfModule : Module {
  static constexpr const char* name = "pdf";
  decltype(&gui::pdfReport) report;
  decltype(&gui::sheetsPdf) sheets;
};

struct SurfaceModule : Module {
  static constexpr const char* name = "surfaces";
  decltype(&recorder::uniteSurfaces) unite;
};

struct DeviceModule : Module {
  static constexpr const char* name = "devices";
  decltype(&recorder::openGamepad) openGamepad;
  decltype(&recorder::listGamepads) listGamepads;
  decltype(&recorder::openSpaceMouse) openSpaceMouse;
  decltype(&recorder::openHaply) openHaply;
  decltype(&recorder::openOpenIgtLink) openOpenIgtLink;
  decltype(&recorder::serveOpenIgtLink) serveOpenIgtLink;
  decltype(&recorder::openFilmSource) openFilmSource;
  decltype(&recorder::openLiveCamera) openLiveCamera;
  decltype(&recorder::listLiveCameras) listLiveCameras;
  decltype(&recorder::makeTagDetector) makeTagDetector;
  decltype(&recorder::tagCells) tagCells;
};

}  // namespace calot::apps
