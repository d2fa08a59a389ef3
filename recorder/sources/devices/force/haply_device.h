// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/force/force_output.h"

namespace calot::recorder {

/// Client's end of a WebSocket (RFC 6455) that carries text, by Boost.Beast. Never blocks longer than asked; nothing
/// throws: a broken connection is closed, which callers can query.
class WebSocketStream {
 public:
  /// @returns a stream that is not open where nobody answered within `wait`; `fault` then says why.
  static WebSocketStream connect(const std::string& host, int port, std::chrono::milliseconds wait, std::string& fault);

  [[nodiscard]] bool open() const;
  /// The next message. @returns false where none came within `wait`, or the stream is closed.
  bool receive(std::string& text, std::chrono::nanoseconds wait);
  /// Sends a message; one that waits for the one before it is replaced by a newer one.
  void send(std::string text);
  /// Says good-bye and closes.
  void close() { inside_.reset(); }

 private:
  struct Inside;
  std::shared_ptr<Inside> inside_;
};

struct HaplySettings {
  std::string host = "localhost";
  int port = 10001;
  std::optional<Hand> hand;  ///< that a single device drives whatever its handedness; none: its own
};

/// Inverse3 by the JSON messages of Haply's Inverse Service, as published for version 3.5 (docs/explanation/forces.md).
/// Not yet run on hardware.
///
/// The service answers each message with one state: a force is sent for each state, at most a thousand a second. Its
/// frame (x right, y forward, z up) is turned into D (x right, y down, z away). A VerseGrip gives orientation and
/// buttons: A closes the jaw, B opens it, both are the clutch, C cuts or fires.
class HaplyDevice final : public ForceFeedbackDevice {
 public:
  /// @throws Error (failure) where no service answers, or it has no Inverse3.
  explicit HaplyDevice(HaplySettings settings, DeviceClock clock = monotonicNanoseconds);
  ~HaplyDevice() override { close(); }

  [[nodiscard]] bool connected() const override { return stream_.open(); }
  void setOut(Hand hand, const HandStart& start) override {
    if (auto& handle = handle_[static_cast<std::size_t>(hand)]) handle->jaw = start.jaw;
  }

 private:
  struct Handle {
    std::string id;  ///< of the Inverse3
    Wrench shown;    ///< command before the last: what was in force until the last state
    Wrench last;
    std::uint64_t sequence = 0;
    double jaw = 0.0;
    std::int64_t time = 0;  ///< ns, of the last state
  };
  std::string connect() override;
  void disconnect() override { stream_.close(); }
  void read(std::chrono::nanoseconds wait, DeviceInput& out) override;
  void sayGoodbye() override { sendForces(); }
  void take(const std::string& text, DeviceInput& out);
  void sample(std::size_t hand, const nlohmann::json& device, const nlohmann::json* grip, DeviceInput& out);
  void sendForces();

  HaplySettings settings_;
  WebSocketStream stream_;
  std::array<std::optional<Handle>, handCount> handle_;
  bool introduced_ = false, due_ = false, toldMalformed_ = false;
  std::int64_t sent_ = 0;
};

extern const DeviceKind haplyKind;
OpenedDevice openHaply(const DeviceRequest& request);

}  // namespace calot::recorder
