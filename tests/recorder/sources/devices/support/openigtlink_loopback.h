// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlServerSocket.h>
#include <igtlTransformMessage.h>

#include <functional>
#include <memory>
#include <vector>

#include "recorder/sources/devices/openigtlink_device.h"

namespace calot::recorder::devicetest {

using std::chrono::milliseconds;

/// The library's server and our client, connected.
class Loopback {
 public:
  Loopback() {
    server_ = igtl::ServerSocket::New();
    EXPECT_EQ(server_->CreateServer(0), 0);
    OpenIgtLinkSettings settings;
    settings.host = "127.0.0.1";
    settings.port = server_->GetServerPort();
    device_ = std::make_unique<OpenIgtLinkDevice>(settings);
    accept();
  }

  void accept() {
    for (int i = 0; i < 200 && !device_->connected(); ++i) device_->poll(milliseconds(10), input);
    EXPECT_TRUE(device_->connected());
    client_ = server_->WaitForConnection(2000);
    ASSERT_TRUE(client_.IsNotNull());
  }

  void send(igtl::MessageBase* message) {
    message->Pack();
    client_->Send(message->GetPackPointer(), message->GetPackSize());
  }
  void sendBytes(const std::vector<std::byte>& bytes) { client_->Send(bytes.data(), static_cast<int>(bytes.size())); }

  /// Polls until `done`, or two seconds have passed.
  bool until(const std::function<bool()>& done) {
    for (int i = 0; i < 200 && !done(); ++i) device_->poll(milliseconds(10), input);
    return done();
  }
  bool untilSamples(std::size_t count) {
    return until([&] { return input.samples.size() >= count; });
  }
  std::size_t events(DeviceEvent::Kind kind) const {
    std::size_t n = 0;
    for (const DeviceEvent& e : input.events) n += e.kind == kind ? 1U : 0U;
    return n;
  }

  void hangUp() { client_->CloseSocket(); }
  OpenIgtLinkDevice& device() { return *device_; }

  DeviceInput input;

 private:
  igtl::ServerSocket::Pointer server_;
  igtl::ClientSocket::Pointer client_;
  std::unique_ptr<OpenIgtLinkDevice> device_;
};

/// A turn of 90 degrees about z, at (10, -20, 30) mm.
inline void fillMatrix(igtl::Matrix4x4& m) {
  igtl::IdentityMatrix(m);
  m[0][0] = 0;
  m[0][1] = -1;
  m[1][0] = 1;
  m[1][1] = 0;
  m[0][3] = 10;
  m[1][3] = -20;
  m[2][3] = 30;
}

inline void expectThatPose(const DeviceSample& s) {
  EXPECT_TRUE(s.valid);
  EXPECT_NEAR((s.position - Vec3(0.01, -0.02, 0.03)).norm(), 0.0, 1e-8);
  EXPECT_NEAR(s.orientation.angularDistance(Quat(Eigen::AngleAxisd(1.5707963267948966, Vec3::UnitZ()))), 0.0, 1e-6);
}

inline igtl::TransformMessage::Pointer transform(const char* name) {
  igtl::TransformMessage::Pointer message = igtl::TransformMessage::New();
  message->SetDeviceName(name);
  igtl::Matrix4x4 m;
  fillMatrix(m);
  message->SetMatrix(m);
  return message;
}

}  // namespace calot::recorder::devicetest
