// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/declared_calibration.h"

#include <fmt/format.h>

#include <cstddef>

#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/sources/devices/mouse_device.h"

namespace calot::recorder {
namespace {

constexpr double leastPixel = 1e-6, mostPixel = 0.005;  // m: 25,000 and 5 counts an inch

}  // namespace

Calibration declaredCalibration(const DeviceInfo& device, double pixel) {
  if (device.name != mouseKind.name)
    throw Error(ErrorKind::invalid, fmt::format("{}: is measured; only a mouse is declared", device.identity));
  if (!(pixel >= leastPixel && pixel <= mostPixel))
    throw Error(ErrorKind::invalid, fmt::format("{:g} mm a pixel: a mouse's are {:g} to {:g}", 1e3 * pixel,
                                                1e3 * leastPixel, 1e3 * mostPixel));
  Calibration out;
  out.device = device.name;
  out.identity = device.identity;
  out.date = presentDate();
  out.declaredPixel = pixel;
  HandCalibration hand;
  hand.rate = device.capabilities.rate;
  hand.longInterval = 1.0 / hand.rate;
  for (int h = 0; h < device.capabilities.hands; ++h) out.hand[static_cast<std::size_t>(h)] = hand;
  return out;
}

}  // namespace calot::recorder
