// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/open_device.h"

#include <fmt/format.h>

#include <iterator>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/nearest_word.h"
#include "recorder/sources/devices/camera/camera_device.h"
#include "recorder/sources/devices/combined_device.h"
#include "recorder/sources/devices/force/force_device.h"
#include "recorder/sources/devices/force/haply_device.h"
#include "recorder/sources/devices/gamepad_device.h"
#include "recorder/sources/devices/mouse_device.h"
#include "recorder/sources/devices/null_device.h"
#include "recorder/sources/devices/openigtlink_device.h"
#include "recorder/sources/devices/scripted_device.h"
#include "recorder/sources/devices/space_mouse.h"

namespace calot::recorder {
namespace {

// References, so that the linker keeps every device of the library.
constexpr std::array kinds{&gamepadKind,  &forceKind, &haplyKind, &openIgtLinkKind, &cameraKind,
                           &scriptedKind, &nullKind,  &mouseKind, &spaceMouseKind};

}  // namespace

void DeviceRequest::refuse(const std::string& why) const {
  throw Error(ErrorKind::invalid, fmt::format("device \"{}\": {}", name.substr(0, 80), why), {Remedy::nameDevice});
}

std::span<const DeviceKind* const> deviceKinds() { return kinds; }

const DeviceKind* findDeviceKind(std::string_view name) {
  const std::string_view kind = name.substr(0, name.find(':'));
  for (const DeviceKind* known : kinds) {
    if (known->name == kind) return known;
  }
  return nullptr;
}

std::string deviceUsage(std::string_view last) {
  std::vector<std::string> usages;
  for (const DeviceKind* kind : kinds) {
    if (!kind->needsWindow) usages.emplace_back(kind->usage);
  }
  const std::string final = usages.back();
  usages.pop_back();
  return fmt::format("{} {} {}", fmt::join(usages, ", "), last, final);
}

OpenedDevice openDevice(const std::string& name, const std::array<std::string, handCount>& tools,
                        const Calibration* calibration, std::optional<Hand> hand) {
  if (isCombination(name)) return openCombination(name, tools);
  const std::size_t colon = name.find(':');
  const DeviceRequest request{name, colon == std::string::npos ? "" : name.substr(colon + 1), tools, calibration, hand};
  if (colon != std::string::npos && request.argument.empty()) request.refuse("something is missing behind the colon");
  const DeviceKind* const kind = findDeviceKind(name);
  if (kind == nullptr) {
    std::vector<std::string> known;
    known.reserve(std::size(kinds));
    for (const DeviceKind* each : kinds) known.emplace_back(each->name);
    request.refuse(
        fmt::format("no such device{}; there are {}", didYouMean(name.substr(0, colon), known), deviceUsage("and")));
  }
  return kind->open(request);
}

std::vector<ListedDevice> listDevices() {
  std::vector<ListedDevice> out;
  for (const DeviceKind* kind : kinds) {
    std::vector<ListedDevice> those = kind->list();
    out.insert(out.end(), std::make_move_iterator(those.begin()), std::make_move_iterator(those.end()));
  }
  return out;
}

}  // namespace calot::recorder
