// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/pointer_device.h"

#define SDL_MAIN_HANDLED
#include <fmt/format.h>
#include <SDL.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

constexpr double speed = 0.06, rollSpeed = 1.5, jawSpeed = 1.2;  // m/s, rad/s, rad/s
constexpr double deadZone = 0.12;
constexpr double fullAxis = 32767.0;
constexpr double reach = 0.15;  // m

// SDL counts its users; the events are not wanted, state is asked for instead.
class Subsystem {
 public:
  Subsystem() {
    SDL_SetMainReady();
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_JOYSTICK_ALLOW_BACKGROUND_EVENTS, "1");
    if (SDL_InitSubSystem(SDL_INIT_GAMECONTROLLER) != 0)
      throw Error(ErrorKind::failure, fmt::format("gamepad: the system's gamepads cannot be read: {}", SDL_GetError()));
    SDL_GameControllerEventState(SDL_IGNORE);
    SDL_JoystickEventState(SDL_IGNORE);
  }
  ~Subsystem() { SDL_QuitSubSystem(SDL_INIT_GAMECONTROLLER); }
  Subsystem(const Subsystem&) = delete;
  Subsystem& operator=(const Subsystem&) = delete;
};

}  // namespace

struct GamepadDevice::Sdl {
  Subsystem subsystem;
  SDL_GameController* controller = nullptr;
  SDL_JoystickGUID model{};
  bool known = false;

  ~Sdl() { close(); }
  void close() {
    if (controller != nullptr) SDL_GameControllerClose(std::exchange(controller, nullptr));
  }

  // Opens the first that fits; once one was open, only one of the same model.
  bool find(const std::string& name) {
    SDL_GameControllerUpdate();
    for (int i = 0; i < SDL_NumJoysticks(); ++i) {
      if (SDL_IsGameController(i) == SDL_FALSE) continue;
      // The other hand's: SDL would give the same one twice.
      if (SDL_GameControllerFromInstanceID(SDL_JoystickGetDeviceInstanceID(i)) != nullptr) continue;
      const SDL_JoystickGUID guid = SDL_JoystickGetDeviceGUID(i);
      if (known ? std::memcmp(&guid, &model, sizeof guid) != 0
                : nameFrom(SDL_GameControllerNameForIndex(i)).find(name) == std::string::npos)
        continue;
      controller = SDL_GameControllerOpen(i);
      if (controller == nullptr) continue;
      model = guid;
      known = true;
      return true;
    }
    return false;
  }

  /// Speed in [-1, 1].
  [[nodiscard]] double axis(SDL_GameControllerAxis which) const {
    return speedOf(static_cast<double>(SDL_GameControllerGetAxis(controller, which)) / fullAxis, deadZone);
  }
  [[nodiscard]] bool pressed(SDL_GameControllerButton which) const {
    return SDL_GameControllerGetButton(controller, which) != 0;
  }
};

GamepadDevice::GamepadDevice(const std::string& name, DeviceClock clock, std::optional<Hand> only)
    : PointerDevice(std::move(clock), gamepadKind.name, reach),
      sdl_(std::make_unique<Sdl>()),
      name_(name),
      hand_(only.value_or(Hand::right)),
      bound_(only.has_value()) {
  connectFirst("gamepad");
  info_.detail = nameFrom(SDL_GameControllerName(sdl_->controller));
  info_.identity = "gamepad:" + info_.detail;
}

GamepadDevice::~GamepadDevice() = default;

bool GamepadDevice::connected() const { return sdl_->controller != nullptr; }

void GamepadDevice::disconnect() { sdl_->close(); }

std::string GamepadDevice::find() {
  if (sdl_->find(name_)) return {};
  return name_.empty() ? "none is attached; plug one in" : fmt::format("none that is called \"{}\" is attached", name_);
}

std::string GamepadDevice::readControls() {
  SDL_GameControllerUpdate();
  return SDL_GameControllerGetAttached(sdl_->controller) == SDL_FALSE ? "unplugged" : "";
}

void GamepadDevice::advance(double seconds, std::int64_t now, DeviceInput& out) {
  const Sdl& pad = *sdl_;
  const bool switches = pad.pressed(SDL_CONTROLLER_BUTTON_START);
  if (switches && !switching_ && !bound_) hand_ = hand_ == Hand::right ? Hand::left : Hand::right;
  switching_ = switches;
  Pointer& p = pointer_[static_cast<std::size_t>(hand_)];
  const Vec3 direction(pad.axis(SDL_CONTROLLER_AXIS_LEFTX), pad.axis(SDL_CONTROLLER_AXIS_LEFTY),
                       pad.axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT) - pad.axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT) -
                           pad.axis(SDL_CONTROLLER_AXIS_RIGHTY));
  p.move(seconds * speed * direction.cwiseMax(-1.0).cwiseMin(1.0), reach);
  const double turn = pad.axis(SDL_CONTROLLER_AXIS_RIGHTX) + between(pad.pressed(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER),
                                                                     pad.pressed(SDL_CONTROLLER_BUTTON_LEFTSHOULDER));
  p.roll += seconds * rollSpeed * std::clamp(turn, -1.0, 1.0);
  p.openJaw(seconds * jawSpeed *
            between(pad.pressed(SDL_CONTROLLER_BUTTON_DPAD_UP), pad.pressed(SDL_CONTROLLER_BUTTON_DPAD_DOWN)));

  DeviceSample& sample = out.samples.emplace_back(p.sample(hand_, now));
  press(sample.buttons, pad.pressed(SDL_CONTROLLER_BUTTON_X), button::cutPedal);
  press(sample.buttons, pad.pressed(SDL_CONTROLLER_BUTTON_Y), button::coagulatePedal);
  press(sample.buttons, pad.pressed(SDL_CONTROLLER_BUTTON_A), button::fire);
  press(sample.buttons, pad.pressed(SDL_CONTROLLER_BUTTON_B), button::lock);
  press(sample.buttons, pad.pressed(SDL_CONTROLLER_BUTTON_DPAD_RIGHT), button::retractMore);
  press(sample.buttons, pad.pressed(SDL_CONTROLLER_BUTTON_DPAD_LEFT), button::retractLess);
}

std::vector<ListedDevice> listGamepads() {
  const Subsystem subsystem;
  SDL_GameControllerUpdate();
  std::vector<ListedDevice> out;
  const auto add = [&out](const std::string& name, const std::string& detail, bool present) {
    out.push_back({name, detail, present, gamepadKind.row[2], gamepadKind.row[3], gamepadKind.row[4]});
  };
  for (int i = 0; i < SDL_NumJoysticks(); ++i) {
    if (SDL_IsGameController(i) == SDL_FALSE) continue;
    const std::string pad = nameFrom(SDL_GameControllerNameForIndex(i));
    add("gamepad:" + pad, pad, true);
  }
  if (out.empty()) add("gamepad", "none is attached", false);
  return out;
}

OpenedDevice openGamepad(const DeviceRequest& request) {
  return {std::make_unique<GamepadDevice>(request.argument, monotonicNanoseconds, request.hand), nullptr};
}

}  // namespace calot::recorder
