// SPDX-License-Identifier: GPL-3.0-or-later
// Device and reference server over loopback: a live recording with forces, the server killed in the middle, replayed.
#include "recorder/sources/devices/force/force_device.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <thread>

#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/loop.h"
#include "recorder/recording/reader.h"
#include "recorder/recording/writer.h"
#include "recorder/replay.h"
#include "recorder/sources/devices/device_source.h"
#include "recorder/sources/devices/force/force_server.h"
#include "recorder/sources/devices/open_device.h"
#include "tests/support/fault.h"

namespace calot::recorder::force_device_test {
namespace {

using std::chrono::milliseconds;

/// A server on a thread of its own; ends with it.
class ServerThread {
 public:
  explicit ServerThread(int port = 0, std::uint8_t hands = 2) : server_(nullptr, settings(port, hands)) {
    thread_ = std::thread([this] { server_.run(stop_, [](const std::string&) {}); });
  }
  ~ServerThread() {
    stop_ = true;
    thread_.join();
  }
  ServerThread(const ServerThread&) = delete;
  ServerThread& operator=(const ServerThread&) = delete;
  [[nodiscard]] int port() const { return server_.port(); }

 private:
  static ForceServerSettings settings(int port, std::uint8_t hands) {
    ForceServerSettings out;
    out.port = port;
    out.hands = hands;
    return out;
  }
  ForceServer server_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

ForceDeviceSettings at(int port) {
  ForceDeviceSettings out;
  out.host = "127.0.0.1";
  out.port = port;
  return out;
}

bool until(ForceDevice& device, DeviceInput& input, const std::function<bool()>& done) {
  for (int i = 0; i < 2000 && !done(); ++i) device.poll(milliseconds(5), input);
  return done();
}

TEST(ForceDevice, GivesPosesAndShowsForces) {
  const ServerThread server;
  ForceDevice device(at(server.port()));
  EXPECT_EQ(device.info().capabilities.hands, 1);
  EXPECT_EQ(device.info().capabilities.actuated, 3);
  EXPECT_EQ(device.info().capabilities.maxForce, 8.0);
  DeviceInput input;
  // The hand reaches 65 mm away within two seconds; a spring of 200 N/m stands against it, the arm has 135 N/m.
  ASSERT_TRUE(until(device, input, [&] {
    if (input.samples.empty()) return false;
    const double depth = input.samples.back().position.z();
    device.setWrench(Hand::right, {Vec3(0, 0, -200.0 * std::max(0.0, depth)), Vec3::Zero()});
    return input.samples.size() >= 2000;
  }));
  double deepest = 0.0;
  for (std::size_t i = 0; i < input.samples.size(); ++i) {
    EXPECT_EQ(input.samples[i].sequence, i);
    EXPECT_TRUE(input.samples[i].valid);
    if (i > 0) {
      EXPECT_GT(input.samples[i].deviceTime, input.samples[i - 1].deviceTime);
    }
    deepest = std::max(deepest, input.samples[i].position.z());
  }
  EXPECT_GT(deepest, 0.011);
  EXPECT_LT(deepest, 0.045);
  device.close();
  EXPECT_FALSE(device.connected());
  EXPECT_EQ(device.forceStatistics()[0].sent, 0U);
  EXPECT_GT(device.forceStatistics()[1].sent, 0U);
}

TEST(ForceDevice, WhatIsNotThereOrAnotherProtocolIsSaid) {
  int free = 0;
  {
    const TcpListener listener(0);
    free = listener.port();
  }
  expectFault(ErrorKind::failure, "", {std::to_string(free)}, [&] { ForceDevice device(at(free)); },
              {Remedy::listDevices});
  const ServerThread right;  // has no left hand
  EXPECT_THROW(openDevice("force:127.0.0.1:" + std::to_string(right.port()), {}, nullptr, Hand::left), Error);
  for (const char* name : {"force:h:", "force:h:0", "force:h:x", "force::1", "force:a b:1"}) {
    expectFault(ErrorKind::invalid, "", {std::string("\"") + name + "\""}, [&] { openDevice(name, {}); },
                {Remedy::nameDevice});
  }
}

/// The must of every device: unplugged in mid-run, the recording goes on, ends well, and replays bit for bit.
TEST(ForceDevice, KilledInMidRunTheRecordingReplays) {
  LoadedScene scene = loadScene(findScene("touch-liver", {std::filesystem::path(CALOT_SOURCE_DIR) / "assets"}));
  const Model::Built built = Model::build(scene.description);
  ASSERT_TRUE(built.model) << built.error;
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("calot-force-" + std::to_string(getpid()) + ".h5");
  auto server = std::make_unique<ServerThread>();
  const int port = server->port();
  RunReport report;
  std::uint64_t losses = 0;
  std::thread person;
  {
    DeviceSource source(std::make_unique<ForceDevice>(at(port)), built.model->scene(), {});
    source.waitForFirst(10.0);
    AttemptSettings attempt;
    attempt.seed = 1;
    const AttemptHeader header = makeHeader(*built.model, std::move(scene.assets), source.provenance(), attempt);
    WorkerPool pool(1);
    RecordingWriter writer(file, header, {true});
    writer.takeRawSamples(source.rawSamples());
    Session session(*built.model, 1, pool);
    session.join(writer);
    RunSettings run;
    run.live = true;
    run.seconds = 2.5;
    run.feedback = [&](const TickOutcome& tick) {
      std::array<Wrench, handCount> wrench;
      for (std::size_t h = 0; h < handCount; ++h) wrench[h] = {tick.hand[h].force, tick.hand[h].torque};
      source.feedback(wrench);
    };
    run.progress = [&](std::uint64_t step) {
      if (step != 100) return;
      person = std::thread([&] {
        server.reset();
        std::this_thread::sleep_for(milliseconds(300));
        server = std::make_unique<ServerThread>(port);
      });
    };
    report = runAttempt(session, source, run);
    writer.finish();
    losses = source.counts().losses;
  }
  if (person.joinable()) person.join();
  EXPECT_EQ(report.outcome, Outcome::stopped);
  EXPECT_EQ(report.disagreements, 0U);
  EXPECT_EQ(report.pauses.count, 1U);
  EXPECT_EQ(losses, 1U);
  std::error_code ignored;
  const ReplayReport replayed = replayRecording(file, ReplaySettings{});
  EXPECT_EQ(replayed.verdict, ReplayVerdict::exact) << replayed.error;
  EXPECT_TRUE(replayed.complete);
  std::filesystem::remove(file, ignored);
}

}  // namespace
}  // namespace calot::recorder::force_device_test
