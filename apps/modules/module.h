// SPDX-License-Identifier: GPL-3.0-or-later
// Modules are loaded when a command first needs them, so that the command line starts fast and is built and installed
// without their libraries. NAME_module.cpp is a module's side of its table, NAME_late.cpp the command line's.
#pragma once

#include <string>

#include "gui/film/film_writer.h"
#include "gui/report/pdf_report.h"
#include "recorder/sources/devices/camera/frame_source.h"
#include "recorder/sources/devices/camera/marker_sheets.h"
#include "recorder/sources/devices/force/haply_device.h"
#include "recorder/sources/devices/openigtlink_device.h"
#include "recorder/sources/devices/pointer_device.h"
#include "recorder/surfaces/surface_union.h"

namespace calot::apps {

/// A table of functions. A module holds static copies of the libraries that its functions use: only values and abstract
/// classes cross, and a table fits the program that was built with it alone.
struct Module {
  const char* build;  ///< CALOT_MODULE_BUILD
};

/// @return the table of <programs>/../lib/calot/NAME.so
/// @throws Error (failure) that names the file, where it is missing, damaged or of another build
const Module& loadModule(const std::string& name);

template <class Table>
const Table& module() {
  static const Table& table = static_cast<const Table&>(loadModule(Table::name));
  return table;
}

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
