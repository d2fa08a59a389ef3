// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/gamepad_device.h"

#define SDL_MAIN_HANDLED
#include <fmt/format.h>
#include <SDL.h>

#include <algorithm>
#include <cstring>
#include <thread>
#include <utility>

#include "recorder/base/errors.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot::recorder {
namespace {

constexpr std::int64_t period = 4'000'000;                       // ns from sample to sample
constexpr std::int64_t between = 500'000'000;                    // ns from one search for a lost gamepad to the next
constexpr double maxStep = 0.05;                                 // s; after a longer gap the pointer does not leap
constexpr double speed = 0.06, rollSpeed = 1.5, jawSpeed = 1.2;  // m/s, rad/s, rad/s
constexpr double largestJaw = 1.2;                               // rad
constexpr double deadZone = 0.12;
constexpr double fullAxis = 32767.0;
const Vec3 reach(0.15, 0.15, 0.15);  // m

std::string printable(const char* text) {
  std::string out;
  for (const char* c = text != nullptr ? text : "unknown"; *c != '\0' && out.size() < 64; ++c)
    out += static_cast<unsigned char>(*c) >= 0x20 && static_cast<unsigned char>(*c) < 0x7f ? *c : '?';
  return out;
}

// Deflection in [-1, 1] beyond the dead zone, squared with its sign.
double response(double axis) {
  const double size = std::min(1.0, axis < 0.0 ? -axis : axis);
  if (size <= deadZone) return 0.0;
  const double d = (size - deadZone) / (1.0 - deadZone);
  return axis < 0.0 ? -d * d : d * d;
}

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
                : printable(SDL_GameControllerNameForIndex(i)).find(name) == std::string::npos)
        continue;
      controller = SDL_GameControllerOpen(i);
      if (controller == nullptr) continue;
      model = guid;
      known = true;
      return true;
    }
    return false;
  }

  [[nodiscard]] double axis(SDL_GameControllerAxis which) const {
    return static_cast<double>(SDL_GameControllerGetAxis(controller, which)) / fullAxis;
  }
  [[nodiscard]] bool pressed(SDL_GameControllerButton which) const {
    return SDL_GameControllerGetButton(controller, which) != 0;
  }
};

GamepadDevice::GamepadDevice(const std::string& name, DeviceClock clock, std::optional<Hand> only)
    : sdl_(std::make_unique<Sdl>()),
      clock_(std::move(clock)),
      hand_(only.value_or(Hand::right)),
      bound_(only.has_value()) {
  if (!sdl_->find(name)) {
    throw Error(ErrorKind::failure,
                name.empty() ? "gamepad: none is attached; plug one in"
                             : fmt::format("gamepad: none that is called \"{}\" is attached", name),
                {Remedy::listDevices});
  }
  const std::string called = printable(SDL_GameControllerName(sdl_->controller));
  info_.name = gamepadKind.name;
  info_.identity = "gamepad:" + called;
  info_.detail = called;
  DeviceCapabilities& c = info_.capabilities;
  c.hands = 1;
  c.sensedRotations = 1;
  c.sensesGripper = true;
  c.workspace = {Vec3(-reach), reach};
  c.rate = 250.0;
  c.absolute = false;
  last_ = clock_();
}

GamepadDevice::~GamepadDevice() = default;

bool GamepadDevice::connected() const { return sdl_ && sdl_->controller != nullptr; }

void GamepadDevice::close() { sdl_.reset(); }

void GamepadDevice::put(std::int64_t now, double seconds, DeviceInput& out) {
  const Sdl& pad = *sdl_;
  const auto pressed = [&](SDL_GameControllerButton b) { return pad.pressed(b) ? 1.0 : 0.0; };
  const bool switches = pad.pressed(SDL_CONTROLLER_BUTTON_START);
  if (switches && !switching_ && !bound_) hand_ = hand_ == Hand::right ? Hand::left : Hand::right;
  switching_ = switches;
  const auto h = static_cast<std::size_t>(hand_);
  Pointer& p = pointer_[h];
  const Vec3 direction(response(pad.axis(SDL_CONTROLLER_AXIS_LEFTX)), response(pad.axis(SDL_CONTROLLER_AXIS_LEFTY)),
                       response(pad.axis(SDL_CONTROLLER_AXIS_TRIGGERRIGHT)) -
                           response(pad.axis(SDL_CONTROLLER_AXIS_TRIGGERLEFT)) -
                           response(pad.axis(SDL_CONTROLLER_AXIS_RIGHTY)));
  p.position += seconds * speed * direction.cwiseMax(-1.0).cwiseMin(1.0);
  p.position = p.position.cwiseMax(-reach).cwiseMin(reach);
  const double turn = response(pad.axis(SDL_CONTROLLER_AXIS_RIGHTX)) + pressed(SDL_CONTROLLER_BUTTON_RIGHTSHOULDER) -
                      pressed(SDL_CONTROLLER_BUTTON_LEFTSHOULDER);
  p.roll += seconds * rollSpeed * std::clamp(turn, -1.0, 1.0);
  const double open = pressed(SDL_CONTROLLER_BUTTON_DPAD_UP) - pressed(SDL_CONTROLLER_BUTTON_DPAD_DOWN);
  p.jaw = std::min(notNegative(p.jaw + seconds * jawSpeed * open), largestJaw);

  DeviceSample sample;
  sample.hostTime = now;
  sample.sequence = sequence_[h]++;
  sample.hand = hand_;
  sample.position = p.position;
  sample.orientation = Quat(cosine(0.5 * p.roll), 0.0, 0.0, sine(0.5 * p.roll));
  sample.gripper = p.jaw;
  const auto bit = [&](SDL_GameControllerButton b, std::uint8_t mask) {
    if (pad.pressed(b)) sample.buttons = static_cast<std::uint8_t>(sample.buttons | mask);
  };
  bit(SDL_CONTROLLER_BUTTON_X, button::cutPedal);
  bit(SDL_CONTROLLER_BUTTON_Y, button::coagulatePedal);
  bit(SDL_CONTROLLER_BUTTON_A, button::fire);
  bit(SDL_CONTROLLER_BUTTON_B, button::lock);
  bit(SDL_CONTROLLER_BUTTON_DPAD_RIGHT, button::retractMore);
  bit(SDL_CONTROLLER_BUTTON_DPAD_LEFT, button::retractLess);
  out.samples.push_back(sample);
}

void GamepadDevice::poll(std::chrono::nanoseconds wait, DeviceInput& out) {
  if (!sdl_) return;
  std::int64_t now = clock_();
  if (sdl_->controller == nullptr) {
    if (now < nextAttempt_) {
      std::this_thread::sleep_for(std::min<std::chrono::nanoseconds>(wait, std::chrono::milliseconds(20)));
      return;
    }
    nextAttempt_ = now + between;
    if (!sdl_->find("")) return;
    out.events.push_back({DeviceEvent::Kind::connected, now, info_.identity + ": there again"});
    last_ = now;
  }
  if (!greeted_) {
    greeted_ = true;
    out.events.push_back({DeviceEvent::Kind::connected, now, info_.identity + ": there"});
  }
  if (now < last_ + period && wait.count() > 0) {
    std::this_thread::sleep_for(std::min(wait, std::chrono::nanoseconds(last_ + period - now)));
    now = clock_();
  }
  if (now < last_ + period) return;
  SDL_GameControllerUpdate();
  if (SDL_GameControllerGetAttached(sdl_->controller) == SDL_FALSE) {
    sdl_->close();
    nextAttempt_ = now;
    out.events.push_back({DeviceEvent::Kind::disconnected, now, info_.identity + ": unplugged"});
    return;
  }
  put(now, std::min(maxStep, 1e-9 * static_cast<double>(now - last_)), out);
  last_ = now;
}

std::vector<std::string> listGamepads() {
  const Subsystem subsystem;
  SDL_GameControllerUpdate();
  std::vector<std::string> names;
  for (int i = 0; i < SDL_NumJoysticks(); ++i) {
    if (SDL_IsGameController(i) == SDL_TRUE) names.push_back(printable(SDL_GameControllerNameForIndex(i)));
  }
  return names;
}

constinit const DeviceKind gamepadKind{
    .name = "gamepad",
    .usage = "gamepad[:NAME]",
    .help = "the first gamepad whose name contains NAME; drives one hand at a time",
    .list =
        [] {
          std::vector<ListedDevice> out;
          const auto add = [&out](const std::string& name, const std::string& detail, bool present) {
            out.push_back({name, detail, present, "1 at a time", "3 + roll, jaw, buttons", "250"});
          };
          try {
            for (const std::string& pad : listGamepads()) add("gamepad:" + pad, pad, true);
            if (out.empty()) add("gamepad", "none is attached", false);
          } catch (const Error& e) {
            add("gamepad", e.what(), false);
          }
          return out;
        },
    .open =
        [](const DeviceRequest& request) {
          return OpenedDevice{std::make_unique<GamepadDevice>(request.argument, monotonicNanoseconds, request.hand),
                              nullptr};
        },
};

}  // namespace calot::recorder
