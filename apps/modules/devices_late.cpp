// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/modules/tables.h"

namespace calot::recorder {
namespace {
const apps::DeviceModule& drivers() { return apps::module<apps::DeviceModule>(); }
}  // namespace

OpenedDevice openGamepad(const DeviceRequest& request) { return drivers().openGamepad(request); }
std::vector<ListedDevice> listGamepads() { return drivers().listGamepads(); }
OpenedDevice openSpaceMouse(const DeviceRequest& request) { return drivers().openSpaceMouse(request); }
OpenedDevice openHaply(const DeviceRequest& request) { return drivers().openHaply(request); }
OpenedDevice openOpenIgtLink(const DeviceRequest& request) { return drivers().openOpenIgtLink(request); }
void serveOpenIgtLink(const DeviceScript& motion, const OpenIgtLinkServerSettings& settings,
                      const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell) {
  drivers().serveOpenIgtLink(motion, settings, stop, tell);
}
std::unique_ptr<FrameSource> openFilmSource(const std::filesystem::path& file) {
  return drivers().openFilmSource(file);
}
std::unique_ptr<FrameSource> openLiveCamera(const std::string& file, int width, int height) {
  return drivers().openLiveCamera(file, width, height);
}
std::vector<std::array<std::string, 2>> listLiveCameras() { return drivers().listLiveCameras(); }
TagDetector makeTagDetector() { return drivers().makeTagDetector(); }
std::array<bool, 100> tagCells(int id) { return drivers().tagCells(id); }

}  // namespace calot::recorder
