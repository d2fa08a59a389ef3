// SPDX-License-Identifier: GPL-3.0-or-later
// Haply's Inverse Service as its documentation describes it, with a simulated Inverse3 in a simulated hand: an
// inventory first, then one state for each message.
#pragma once

#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "recorder/sources/devices/force/force_server.h"

namespace calot::recorder::devicetest {

class HaplyService {
 public:
  explicit HaplyService(std::vector<std::string> handedness, unsigned short port = 0)
      : handedness_(std::move(handedness)),
        acceptor_(io_, {boost::asio::ip::address_v4::loopback(), port}, true),
        thread_([this] { run(); }) {}
  ~HaplyService() {
    stop_ = true;
    // A connection wakes the acceptor.
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket knock(io);
    boost::system::error_code ignored;
    knock.connect(acceptor_.local_endpoint(), ignored);
    hangUp();
    thread_.join();
  }
  HaplyService(const HaplyService&) = delete;
  HaplyService& operator=(const HaplyService&) = delete;

  [[nodiscard]] int port() const { return acceptor_.local_endpoint().port(); }
  void press(const char* button, bool down) {
    const std::lock_guard<std::mutex> lock(mutex_);
    buttons_[button] = down;
  }
  void hangUp() {
    const std::lock_guard<std::mutex> lock(mutex_);
    boost::system::error_code ignored;
    if (client_ != nullptr) client_->shutdown(boost::asio::ip::tcp::socket::shutdown_both, ignored);
  }
  [[nodiscard]] double maxForce() const { return maxForce_; }
  [[nodiscard]] double maxChange() const { return maxChange_; }
  [[nodiscard]] bool introduced() const { return introduced_; }

 private:
  using Json = nlohmann::json;
  static Json vectorOf(const Vec3& v) { return {{"x", v.x()}, {"y", v.y()}, {"z", v.z()}}; }

  Json state(bool full) {
    Json out;
    if (full) out["session_id"] = 7;
    out["inverse3"] = Json::array();
    for (std::size_t i = 0; i < handedness_.size(); ++i) {
      Json device{{"device_id", "0" + std::to_string(i)},
                  {"state",
                   {{"cursor_position", vectorOf(hand_[i].measured())},
                    {"cursor_velocity", vectorOf(hand_[i].velocity())},
                    {"current_cursor_force", vectorOf(force_[i])}}},
                  {"status", Json::object()}};
      if (full) device["config"] = {{"type", "inverse3"}, {"handedness", handedness_[i]}};
      out["inverse3"].push_back(std::move(device));
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    out["wireless_verse_grip"] = Json::array(
        {{{"device_id", "g0"},
          {"state", {{"orientation", {{"w", 1.0}, {"x", 0.0}, {"y", 0.0}, {"z", 0.0}}}, {"buttons", buttons_}}}}});
    return out;
  }

  void obey(const Json& message) {
    if (message.contains("session")) introduced_ = true;
    if (!message.contains("inverse3")) return;
    for (const Json& device : message["inverse3"]) {
      const auto i = static_cast<std::size_t>(std::stoi(device.at("device_id").get<std::string>()));
      const Json& values = device.at("commands").at("set_cursor_force").at("values");
      const Vec3 force(values.at("x").get<double>(), values.at("y").get<double>(), values.at("z").get<double>());
      maxForce_ = std::max(maxForce_.load(), force.norm());
      maxChange_ = std::max(maxChange_.load(), (force - force_.at(i)).norm());
      force_.at(i) = force;
    }
  }

  void run() {
    while (!stop_) {
      boost::system::error_code fault;
      boost::asio::ip::tcp::socket client(io_);
      acceptor_.accept(client, fault);
      if (fault || stop_) continue;
      boost::beast::websocket::stream<boost::asio::ip::tcp::socket> stream(std::move(client));
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        client_ = &stream.next_layer();
      }
      stream.accept(fault);
      // The hand rests 120 mm in front of the device and 150 mm up, as the documentation's example does.
      hand_.assign(handedness_.size(), SimulatedHand({}, Vec3(0.0, 0.12, 0.15)));
      force_.assign(handedness_.size(), Vec3::Zero());
      if (!fault) stream.write(boost::asio::buffer(state(true).dump()), fault);
      boost::beast::flat_buffer buffer;
      while (!fault && !stop_) {
        buffer.clear();
        stream.read(buffer, fault);
        if (fault) break;
        obey(Json::parse(boost::beast::buffers_to_string(buffer.data())));
        for (std::size_t i = 0; i < hand_.size(); ++i) hand_[i].advance(0.001, force_[i], Vec3(0.0, 0.12, 0.15));
        stream.write(boost::asio::buffer(state(false).dump()), fault);
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      client_ = nullptr;
    }
  }

  std::vector<std::string> handedness_;
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::vector<SimulatedHand> hand_;
  std::vector<Vec3> force_;
  Json buttons_{{"a", false}, {"b", false}, {"c", false}};
  std::mutex mutex_;
  boost::asio::ip::tcp::socket* client_ = nullptr;
  std::atomic<double> maxForce_{0.0}, maxChange_{0.0};
  std::atomic<bool> stop_{false}, introduced_{false};
  std::thread thread_;
};

}  // namespace calot::recorder::devicetest
