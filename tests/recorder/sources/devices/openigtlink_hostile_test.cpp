// SPDX-License-Identifier: GPL-3.0-or-later
// Servers that mean no good.
#include <gtest/gtest.h>
#include <igtlTrackingDataMessage.h>

#include <algorithm>
#include <cstring>
#include <functional>
#include <limits>

#include "sim/math/random.h"
#include "tests/recorder/sources/devices/support/openigtlink_loopback.h"

namespace calot::recorder {
namespace {

using devicetest::expectThatPose;
using devicetest::fillMatrix;
using devicetest::Loopback;
using devicetest::transform;

// What a library packs, with bytes changed in body (and the checksum made right again, where wanted).
std::vector<std::byte> packed(const std::function<void(float*)>& change) {
  igtl::TransformMessage::Pointer message = transform("RightTool");
  igtl::Matrix4x4 m;
  fillMatrix(m);
  std::array<float, 16> flat{};
  std::memcpy(flat.data(), m, sizeof m);
  change(flat.data());
  std::memcpy(m, flat.data(), sizeof m);
  message->SetMatrix(m);
  message->Pack();
  std::vector<std::byte> bytes(static_cast<std::size_t>(message->GetPackSize()));
  std::memcpy(bytes.data(), message->GetPackPointer(), bytes.size());
  return bytes;
}

TEST(OpenIgtLink, PosesThatAreNoneAreInvalidSamplesAndToldOnce) {
  Loopback link;
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::vector<std::function<void(float*)>> changes{[&](float* m) { m[0] = nan; },
                                                         [&](float* m) { m[3] = nan; },
                                                         [&](float* m) { m[7] = inf; },
                                                         [&](float* m) { m[11] = 1e38F; },
                                                         [&](float* m) { m[3] = 1e5F; },
                                                         [&](float* m) { m[0] = 0.5F; },
                                                         [&](float* m) { m[10] = -1; },  // mirrored
                                                         [&](float* m) { std::fill(m, m + 12, 0.0F); },
                                                         [&](float* m) { m[1] = -1e30F; }};
  for (const auto& change : changes) link.sendBytes(packed(change));
  link.sendBytes(packed([](float*) {}));
  ASSERT_TRUE(link.untilSamples(changes.size() + 1));
  for (std::size_t i = 0; i < changes.size(); ++i) {
    EXPECT_FALSE(link.input.samples[i].valid) << i;
    EXPECT_TRUE(link.input.samples[i].position.allFinite());
    EXPECT_TRUE(link.input.samples[i].orientation.coeffs().allFinite());
  }
  expectThatPose(link.input.samples.back());
  EXPECT_EQ(link.events(DeviceEvent::Kind::malformed), 1U);
}

TEST(OpenIgtLink, BadChecksumsAndSizesAreInvalidAndTheStreamGoesOn) {
  Loopback link;
  std::vector<std::byte> bytes = packed([](float*) {});
  bytes.back() ^= std::byte{1};
  link.sendBytes(bytes);
  bytes = packed([](float*) {});
  bytes[49] = std::byte{44};  // body_size, whose checksum then is wrong
  bytes.resize(58 + 44);
  link.sendBytes(bytes);
  igtl::TrackingDataMessage::Pointer empty = igtl::TrackingDataMessage::New();
  empty->SetDeviceName("x");
  link.send(empty);
  link.send(transform("RightTool"));
  ASSERT_TRUE(link.until([&] { return !link.input.samples.empty() && link.input.samples.back().valid; }));
  EXPECT_EQ(link.input.samples.size(), 3U);
  EXPECT_FALSE(link.input.samples[0].valid);
  EXPECT_FALSE(link.input.samples[1].valid);
  EXPECT_TRUE(link.device().connected());
}

TEST(OpenIgtLink, HugeBodiesAreSkippedOrRefusedWithoutMemory) {
  // A body of 4 GB that never comes is skipped as it comes; one of a type that is read, or beyond that, is no header.
  for (const int byte : {0x01, 0x00}) {
    Loopback link;
    std::vector<std::byte> bytes = packed([](float*) {});
    bytes[42 + 3] = std::byte{1};  // body_size + 2^32
    bytes[42] = std::byte(byte);   // and 2^56
    link.sendBytes(bytes);
    EXPECT_TRUE(link.until([&] { return !link.device().connected(); }));
    EXPECT_EQ(link.events(DeviceEvent::Kind::malformed), 1U);
  }
  Loopback link;
  std::vector<std::byte> image = packed([](float*) {});
  for (std::size_t i = 2; i < 14; ++i) image[i] = std::byte{0};
  std::memcpy(image.data() + 2, "IMAGE", 5);
  image[42 + 5] = std::byte{1};  // 65,584 bytes, of which 48 are here
  link.sendBytes(image);
  link.sendBytes(std::vector<std::byte>(65536));
  link.send(transform("LeftTool"));
  ASSERT_TRUE(link.untilSamples(1));
  expectThatPose(link.input.samples[0]);
}

TEST(OpenIgtLink, HalfAMessageAndAClosedDoor) {
  const std::vector<std::byte> whole = packed([](float*) {});
  for (const std::size_t length : {std::size_t{1}, std::size_t{57}, std::size_t{58}, whole.size() - 1}) {
    Loopback link;
    link.sendBytes({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)});
    link.hangUp();
    ASSERT_TRUE(link.until([&] { return !link.device().connected(); }));
    EXPECT_TRUE(link.input.samples.empty());
    EXPECT_EQ(link.events(DeviceEvent::Kind::disconnected), 1U);
    link.accept();  // and what was left of it does not spoil the next connection
    link.sendBytes(whole);
    ASSERT_TRUE(link.untilSamples(1));
    expectThatPose(link.input.samples[0]);
  }
}

TEST(OpenIgtLink, GarbageNeverCrashesTheDecoder) {
  Random random(7, 1);
  const std::vector<std::byte> whole = packed([](float*) {});
  std::size_t lost = 0, items = 0;
  for (int run = 0; run < 3000; ++run) {
    std::vector<std::byte> bytes;
    for (int i = 0; i < 4; ++i) bytes.insert(bytes.end(), whole.begin(), whole.end());
    const std::uint32_t changes = run % 3 == 0 ? 400U : 3U;
    for (std::uint32_t i = 0; i < changes; ++i) bytes[random.next() % bytes.size()] = std::byte(random.next() & 0xffU);
    openigtlink::Decoder decoder;
    std::size_t at = 0;
    bool sound = true;
    while (at < bytes.size() && sound) {
      const std::size_t n = std::min<std::size_t>(1 + random.next() % 200, bytes.size() - at);
      sound = decoder.take(std::span(bytes).subspan(at, n), [&](const openigtlink::Item& item) {
        ++items;
        if (item.kind == openigtlink::Item::Kind::pose) {
          EXPECT_TRUE(item.position.allFinite());
          EXPECT_NEAR(item.orientation.norm(), 1.0, 1e-6);
        }
        for (const char c : item.name + item.text) EXPECT_TRUE(c >= 0x20 && c < 0x7f);
      });
      at += n;
    }
    if (!sound) ++lost;
  }
  EXPECT_GT(lost, 100U);
  EXPECT_GT(items, 3000U);
}

}  // namespace
}  // namespace calot::recorder
