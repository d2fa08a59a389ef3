// SPDX-License-Identifier: GPL-3.0-or-later
// Against the OpenIGTLink library's own server and client, over loopback.
#include <gtest/gtest.h>
#include <igtlClientSocket.h>
#include <igtlQuaternionTrackingDataMessage.h>
#include <igtlSensorMessage.h>
#include <igtlServerSocket.h>
#include <igtlStatusMessage.h>
#include <igtlTrackingDataMessage.h>
#include <igtlTransformMessage.h>

#include <atomic>
#include <future>
#include <thread>
#include <utility>

#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/openigtlink_device.h"
#include "tests/recorder/sources/devices/support/device_support.h"
#include "tests/recorder/sources/devices/support/openigtlink_loopback.h"

namespace calot::recorder {
namespace {

using std::chrono::milliseconds;

using devicetest::expectThatPose;
using devicetest::fillMatrix;
using devicetest::Loopback;
using devicetest::transform;

TEST(OpenIgtLink, TransformsOfNamedToolsBecomeSamples) {
  Loopback link;
  igtl::TransformMessage::Pointer left = transform("LeftTool");
  igtl::TimeStamp::Pointer stamp = igtl::TimeStamp::New();
  stamp->SetTime(1234567890U, 500000000U);
  left->SetTimeStamp(stamp);
  link.send(left);
  link.send(transform("Probe"));
  link.send(transform("RightTool"));
  ASSERT_TRUE(link.untilSamples(2));
  ASSERT_EQ(link.input.samples.size(), 2U);
  EXPECT_EQ(link.input.samples[0].hand, Hand::left);
  EXPECT_EQ(link.input.samples[1].hand, Hand::right);
  for (const DeviceSample& s : link.input.samples) {
    expectThatPose(s);
    EXPECT_EQ(s.sequence, 0U);
    EXPECT_GT(s.hostTime, 0);
  }
  EXPECT_NEAR(static_cast<double>(link.input.samples[0].deviceTime - 1'234'567'890'500'000'000), 0.0, 100.0);
  EXPECT_EQ(link.events(DeviceEvent::Kind::malformed), 0U);
}

TEST(OpenIgtLink, TrackingDataOfBothKinds) {
  Loopback link;
  igtl::TrackingDataMessage::Pointer tdata = igtl::TrackingDataMessage::New();
  tdata->SetDeviceName("Tracker");
  for (const char* name : {"RightTool", "LeftTool"}) {
    igtl::TrackingDataElement::Pointer e = igtl::TrackingDataElement::New();
    e->SetName(name);
    e->SetType(igtl::TrackingDataElement::TYPE_6D);
    igtl::Matrix4x4 m;
    fillMatrix(m);
    e->SetMatrix(m);
    tdata->AddTrackingDataElement(e);
  }
  link.send(tdata);
  igtl::QuaternionTrackingDataMessage::Pointer qtdata = igtl::QuaternionTrackingDataMessage::New();
  qtdata->SetDeviceName("Tracker");
  igtl::QuaternionTrackingDataElement::Pointer e = igtl::QuaternionTrackingDataElement::New();
  e->SetName("LeftTool");
  e->SetType(igtl::QuaternionTrackingDataElement::TYPE_6D);
  e->SetPosition(10, -20, 30);
  e->SetQuaternion(0, 0, 0.70710678F, 0.70710678F);
  qtdata->AddQuaternionTrackingDataElement(e);
  link.send(qtdata);
  ASSERT_TRUE(link.untilSamples(3));
  for (const DeviceSample& s : link.input.samples) expectThatPose(s);
  EXPECT_EQ(link.input.samples[0].hand, Hand::right);
  EXPECT_EQ(link.input.samples[2].sequence, 1U);
}

TEST(OpenIgtLink, SensorsOpenTheJawAndStatusIsTold) {
  Loopback link;
  igtl::SensorMessage::Pointer sensor = igtl::SensorMessage::New();
  sensor->SetDeviceName("LeftToolJaw");
  sensor->SetLength(1);
  igtlFloat64 opening = 0.625;
  sensor->SetValue(&opening);
  link.send(sensor);
  igtl::StatusMessage::Pointer status = igtl::StatusMessage::New();
  status->SetDeviceName("Tracker");
  status->SetCode(igtl::StatusMessage::STATUS_NOT_READY);
  status->SetStatusString("warming\nup");
  link.send(status);
  link.send(transform("LeftTool"));
  ASSERT_TRUE(link.untilSamples(1));
  EXPECT_EQ(link.input.samples[0].gripper, 0.625);
  ASSERT_EQ(link.events(DeviceEvent::Kind::status), 1U);
  for (const DeviceEvent& event : link.input.events) EXPECT_EQ(event.text.find('\n'), std::string::npos);
}

TEST(OpenIgtLink, ConnectsAgainWhenTheServerComesBack) {
  Loopback link;
  link.send(transform("LeftTool"));
  ASSERT_TRUE(link.untilSamples(1));
  link.hangUp();
  ASSERT_TRUE(link.until([&] { return !link.device().connected(); }));
  EXPECT_EQ(link.events(DeviceEvent::Kind::disconnected), 1U);
  link.accept();
  EXPECT_EQ(link.events(DeviceEvent::Kind::connected), 2U);
  link.send(transform("LeftTool"));
  ASSERT_TRUE(link.untilSamples(2));
  EXPECT_EQ(link.input.samples[1].sequence, 1U);
}

TEST(OpenIgtLink, NobodyThereIsOneEventAndNoMore) {
  int port = 0;
  {
    const TcpListener gone(0);
    port = gone.port();
  }
  OpenIgtLinkSettings settings;
  settings.host = "127.0.0.1";
  settings.port = port;
  std::int64_t now = 0;
  OpenIgtLinkDevice device(settings, [&] { return now; });
  DeviceInput input;
  for (int i = 0; i < 5; ++i, now += 1'000'000'000) device.poll(std::chrono::nanoseconds(0), input);
  EXPECT_FALSE(device.connected());
  ASSERT_EQ(input.events.size(), 1U);
  EXPECT_NE(input.events[0].text.find("refused"), std::string::npos) << input.events[0].text;
}

TEST(OpenIgtLinkServer, FeedsTheLibrarysClientAndOurSource) {
  DeviceScript motion = devicetest::movingScript(300, 10, {Hand::left, Hand::right});
  for (DeviceSample& s : motion.samples) s.gripper = 0.5;
  OpenIgtLinkServerSettings settings;
  settings.port = 0;
  settings.speed = 3.0;
  std::atomic<bool> stop{false};
  std::vector<std::string> told;
  std::promise<int> listening;
  bool first = true;
  std::thread thread([&] {
    serveOpenIgtLink(motion, settings, stop, [&](const std::string& line) {
      if (std::exchange(first, false)) {  // its address
        listening.set_value(std::stoi(line.substr(line.rfind(':') + 1)));
      } else {
        told.push_back(line);
      }
    });
  });
  const int port = listening.get_future().get();
  {
    igtl::ClientSocket::Pointer client = igtl::ClientSocket::New();
    ASSERT_EQ(client->ConnectToServer("127.0.0.1", port), 0);
    client->SetReceiveTimeout(2000);
    int transforms = 0;
    for (int i = 0; i < 20; ++i) {
      igtl::MessageHeader::Pointer header = igtl::MessageHeader::New();
      header->InitPack();
      ASSERT_EQ(client->Receive(header->GetPackPointer(), header->GetPackSize()), header->GetPackSize());
      header->Unpack();
      std::vector<char> skipped(static_cast<std::size_t>(header->GetBodySizeToRead()));
      if (std::string(header->GetDeviceType()) != "TRANSFORM") {
        ASSERT_EQ(client->Receive(skipped.data(), static_cast<int>(skipped.size())), static_cast<int>(skipped.size()));
        continue;
      }
      igtl::TransformMessage::Pointer message = igtl::TransformMessage::New();
      message->SetMessageHeader(header);
      message->AllocatePack();
      ASSERT_GT(client->Receive(message->GetPackBodyPointer(), message->GetPackBodySize()), 0);
      EXPECT_NE(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY, 0);
      ++transforms;
    }
    EXPECT_EQ(transforms, 10);
    client->CloseSocket();
  }
  OpenIgtLinkSettings client;
  client.host = "127.0.0.1";
  client.port = port;
  DeviceSource source(std::make_unique<OpenIgtLinkDevice>(client), devicetest::emptyScene(), {});
  source.waitForFirst(10.0);
  TickSamples tick;
  for (std::uint64_t i = 0; i < 200; ++i) {
    ASSERT_TRUE(source.next(i, tick));
    std::this_thread::sleep_for(milliseconds(1));
  }
  EXPECT_EQ(source.provenance().kind, OperatorKind::human);
  EXPECT_EQ(source.status(), SourceStatus::ok);
  EXPECT_EQ(tick.hand[0].jaw, 0.5);
  EXPECT_GE(source.counts().samples, 20U);
  EXPECT_EQ(source.counts().invalid, 0U);
  stop = true;
  thread.join();
  EXPECT_GE(told.size(), 2U);
}

}  // namespace
}  // namespace calot::recorder
