// SPDX-License-Identifier: GPL-3.0-or-later
// The answering side of the engine's protocol: schemas/engine.md.
#include "recorder/engine/engine_server.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "recorder/engine/state_fields.h"
#include "recorder/engine/wire.h"
#include "recorder/recording/reader.h"
#include "sim/scene/scene_viewer.h"
#include "sim/scene/version.h"
#include "tests/recorder/support/lying_recording.h"

namespace calot::recorder {
namespace {

/// An engine, a recording whose steps it can do, and its answers as payloads.
class Server : public testing::Test {
 protected:
  static const Recording& recording() { return stored(); }
  static RecordedStep recorded(std::uint64_t n) { return stored().step(n); }

  template <class Request>
  std::uint32_t ask(const Request& request) {
    return askBytes(Request::kind, encodePayload(request));
  }
  std::uint32_t askBytes(std::uint32_t kind, const wire::Bytes& payload) {
    const std::span<const std::byte> answer = server_->answer(kind, payload);
    EXPECT_GE(answer.size(), messageHead);
    const MessageHead head = parseHead(answer);
    EXPECT_EQ(head.length, answer.size() - messageHead);
    payload_.assign(answer.begin() + messageHead, answer.end());
    return head.kind;
  }
  template <class Answer>
  Answer answer() {
    Answer out;
    EXPECT_TRUE(decode(payload_, out));
    return out;
  }
  wire::FaultCode fault() { return answer<wire::Fault>().code; }

  static wire::Scene scene() {
    wire::Scene scene;
    for (const Asset& asset : recording().header().assets) scene.files.push_back({asset.name, asset.bytes});
    return scene;
  }
  static wire::Step step(std::uint64_t n, std::uint8_t wanted = 0) {
    const RecordedStep of = recorded(n);
    wire::Step step;
    step.wanted = wanted;
    for (std::size_t i = 0; i < of.samples.size(); ++i) step.ticks.push_back({of.samples[i], of.ticks[i]});
    return step;
  }
  void begin() {
    ASSERT_EQ(ask(wire::Hello{}), wire::IsHello::kind);
    ASSERT_EQ(ask(scene()), wire::IsScene::kind);
    ASSERT_EQ(ask(wire::Start{recording().header().seed}), wire::IsReady::kind);
  }

  std::optional<EngineServer> server_{std::in_place, "an engine", Confinement::none};
  wire::Bytes payload_;

 private:
  static Recording& stored() {
    static const test::Folder folder;
    static Recording recording = [] {
      test::recordTouches(folder / "r.h5");
      return Recording(folder / "r.h5");
    }();
    return recording;
  }
};

TEST_F(Server, SaysWhatItIs) {
  ASSERT_EQ(ask(wire::Hello{}), wire::IsHello::kind);
  const auto hello = answer<wire::IsHello>();
  EXPECT_EQ(hello.magic, wire::magic);
  EXPECT_EQ(hello.protocol, 1U);
  EXPECT_EQ(hello.simulation, simulationVersion);
  EXPECT_EQ(hello.result, stepResultVersion);
  EXPECT_EQ(hello.software, "an engine");
  ASSERT_EQ(ask(scene()), wire::IsScene::kind);
  const auto is = answer<wire::IsScene>();
  const AttemptHeader& header = recording().header();
  EXPECT_EQ(is.ticks, header.ticksPerStep);
  EXPECT_EQ(is.components, header.layout.components);
  EXPECT_EQ(is.digested.size(), header.layout.fields.size());
  EXPECT_EQ(is.structures, header.structures());
}

/// The answers hold, byte for byte, what the recorded attempt held when it was made.
TEST_F(Server, GivesTheRecordedAttempt) {
  begin();
  std::size_t events = 0;
  for (std::uint64_t n = 0; n < 120; ++n) {
    const RecordedStep of = recorded(n);
    ASSERT_EQ(ask(step(n, n == 99 ? wire::wantAll : std::uint8_t{0})), wire::IsStep::kind);
    const auto is = answer<wire::IsStep>();
    EXPECT_EQ(is.step, n);
    DigestStream digest;
    for (const std::uint64_t component : is.components) digest.append(&component, sizeof component);
    EXPECT_EQ(digest.value(), of.brief.state);
    DigestStream forces;
    for (const auto& tick : is.forces) forces.append(tick.data(), sizeof tick);
    EXPECT_EQ(forces.value(), of.forces);
    wire::Bytes results;
    appendResultRow(of.result, results);
    EXPECT_EQ(is.results, results) << "step " << n;
    ASSERT_EQ(is.events.size(), of.result.events.size());
    for (std::size_t i = 0; i < is.events.size(); ++i)
      EXPECT_EQ(encodePayload(is.events[i]), encodePayload(wire::toWire(of.result.events[i])));
    events += is.events.size();
    EXPECT_EQ(is.keyframe.empty(), n != 99);
    if (n != 99) continue;
    wire::Keyframe keyframe;
    ASSERT_TRUE(decode(is.keyframe, keyframe));
    const Keyframe stored = Recording(recording().path()).keyframe(0);
    EXPECT_EQ(keyframe.step, 99U);
    EXPECT_EQ(keyframe.state, stored.state);
    EXPECT_EQ(keyframe.haptics, stored.haptics);
    EXPECT_GT(is.sets.size(), 100U);
    EXPECT_GT(is.view.size(), 1000U);
  }
  EXPECT_GT(events, 0U) << "nothing was touched";
}

TEST_F(Server, GoesOnFromAKeyframeAndRefusesAnother) {
  begin();
  Recording reader(recording().path());
  wire::Restore request{wire::toWire(reader.keyframe(0)), 0, {}};
  ASSERT_EQ(ask(step(0)), wire::IsStep::kind);
  wire::Restore broken = request;
  broken.keyframe.state.resize(broken.keyframe.state.size() - 1);
  EXPECT_EQ(ask(broken), wire::IsRefused::kind);
  EXPECT_FALSE(answer<wire::IsRefused>().why.empty());
  ASSERT_EQ(ask(step(1)), wire::IsStep::kind) << "nothing has changed";
  ASSERT_EQ(ask(request), wire::IsReady::kind);
  EXPECT_EQ(answer<wire::IsReady>().steps, 100U);
  ASSERT_EQ(ask(step(100)), wire::IsStep::kind);
  EXPECT_EQ(answer<wire::IsStep>().step, 100U);

  ASSERT_EQ(ask(wire::Explain{request.keyframe}), wire::IsExplained::kind);
  EXPECT_EQ(answer<wire::IsExplained>().differs, 1);
  ASSERT_EQ(ask(wire::AskKeyframe{}), wire::Keyframe::kind);
  const auto own = answer<wire::Keyframe>();
  ASSERT_EQ(ask(wire::Explain{own}), wire::IsExplained::kind);
  EXPECT_EQ(answer<wire::IsExplained>().differs, 0);
}

TEST_F(Server, ShowsTheScene) {
  begin();
  ASSERT_EQ(ask(step(0)), wire::IsStep::kind);
  ASSERT_EQ(ask(wire::AskView{}), wire::View::kind);
  SceneView view;
  ASSERT_TRUE(wire::fromWire(answer<wire::View>(), view));
  SerialExecutor executor;
  const test::SmallScene scene = test::smallScene();
  Session session(*scene.model, recording().header().seed, executor);
  LocalEngine engine(session);
  const RecordedStep of = recorded(0);
  static_cast<void>(engine.step({of.samples, of.ticks, of.lateness}));
  EXPECT_EQ(encodePayload(wire::toWire(view)), encodePayload(wire::toWire(engine.view())));
  // A view whose lists do not fit one another is none.
  wire::View lying = wire::toWire(view);
  lying.surface.at(0).triangle.at(0)[1] = static_cast<int>(lying.surface[0].position.size());
  EXPECT_FALSE(wire::fromWire(lying, view));
}

TEST_F(Server, AnswersInItsOrderAlone) {
  for (const std::uint32_t kind : {2U, 3U, 5U, 6U, 77U}) {
    EngineServer fresh("an engine", Confinement::none);
    static_cast<void>(fresh.answer(kind, {}));
    EXPECT_TRUE(fresh.ended()) << kind;
  }
  ASSERT_EQ(ask(wire::Hello{}), wire::IsHello::kind);
  EXPECT_EQ(ask(wire::Start{1}), wire::Fault::kind);
  EXPECT_EQ(fault(), wire::FaultCode::message);
  EXPECT_TRUE(server_->ended());
  EXPECT_EQ(ask(wire::Hello{}), wire::Fault::kind) << "the end is the end";
}

TEST_F(Server, NeedsAnAttemptAndAStep) {
  ASSERT_EQ(ask(wire::Hello{}), wire::IsHello::kind);
  ASSERT_EQ(ask(scene()), wire::IsScene::kind);
  ASSERT_EQ(ask(wire::AskView{}), wire::Fault::kind);
  EXPECT_EQ(fault(), wire::FaultCode::message);
}

TEST_F(Server, KnowsNoProtocolBeforeTheFirst) {
  wire::Hello hello;
  hello.protocol = 0;
  ASSERT_EQ(ask(hello), wire::Fault::kind);
  EXPECT_EQ(fault(), wire::FaultCode::protocol);
}

TEST_F(Server, SaysWhatIsWrongWithAScene) {
  ASSERT_EQ(ask(wire::Hello{}), wire::IsHello::kind);
  wire::Scene bad = scene();
  bad.files.at(0).content.resize(bad.files[0].content.size() / 2);
  ASSERT_EQ(ask(bad), wire::Fault::kind);
  EXPECT_EQ(fault(), wire::FaultCode::scene);
  EXPECT_NE(answer<wire::Fault>().message.find(bad.files[0].name), std::string::npos);
}

TEST_F(Server, RefusesATickThatIsNoneOrNamesWhatIsNotThere) {
  const auto faultOf = [&](auto&& change) {
    server_.emplace("an engine", Confinement::none);
    begin();
    wire::Step request = step(0);
    change(request);
    EXPECT_EQ(ask(request), wire::Fault::kind);
    return fault();
  };
  EXPECT_EQ(faultOf([](wire::Step& s) { s.ticks.pop_back(); }), wire::FaultCode::message);
  EXPECT_EQ(faultOf([](wire::Step& s) { s.wanted = 8; }), wire::FaultCode::message);
  EXPECT_EQ(faultOf([](wire::Step& s) { s.ticks[3].logged.hand[1].contactSet = 5; }), wire::FaultCode::contactSet);
  EXPECT_EQ(faultOf([](wire::Step& s) { s.ticks[3].samples.hand[1].instrument = static_cast<InstrumentKind>(99); }),
            wire::FaultCode::message);
  EXPECT_EQ(faultOf([](wire::Step& s) { s.ticks[3].samples.hand[0].orientation = Quat(0.5, 0.0, 0.0, 0.0); }),
            wire::FaultCode::message);
  EXPECT_EQ(
      faultOf([](wire::Step& s) { s.ticks[9].samples.hand[0].position[1] = std::numeric_limits<double>::quiet_NaN(); }),
      wire::FaultCode::message);
  EXPECT_EQ(
      faultOf([](wire::Step& s) { s.ticks[9].samples.camera.position[1] = std::numeric_limits<double>::infinity(); }),
      wire::FaultCode::message);
}

/// Whatever comes in: an answer that is a message, and no memory beyond what came in.
TEST_F(Server, AnswersEveryBrokenMessage) {
  const auto seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  Recording reader(recording().path());
  const wire::Bytes whole[] = {encodePayload(wire::Hello{}), encodePayload(wire::Start{1}),
                               encodePayload(wire::Restore{wire::toWire(reader.keyframe(0)), 1, {98, 98}}),
                               encodePayload(step(0, wire::wantAll)),
                               encodePayload(wire::Explain{wire::toWire(reader.keyframe(0))})};
  const std::uint32_t kinds[] = {1, 3, 4, 5, 8};
  // Each has a scene of its own.
#ifdef CALOT_SANITIZED
  constexpr int rounds = 5;
#else
  constexpr int rounds = 60;
#endif
  for (int round = 0; round < rounds; ++round) {
    SCOPED_TRACE(round);
    server_.emplace("an engine", Confinement::none);
    begin();
    if (round % 2 == 0) {
      ASSERT_EQ(ask(step(0)), wire::IsStep::kind);
    }
    const std::size_t which = below(5);
    wire::Bytes payload = whole[which];
    switch (below(3)) {
      case 0:
        payload.resize(below(payload.size() + 1));
        break;
      case 1:
        payload.resize(payload.size() + 1 + below(9));
        break;
      default:
        for (int k = 0; k < 3; ++k) payload[below(payload.size())] ^= static_cast<std::byte>(1U << below(8));
        // A length that no message can keep.
        if (round % 3 == 0) {
          const std::size_t length = sizeof(std::uint64_t);
          std::fill_n(payload.begin() + static_cast<std::ptrdiff_t>(below(payload.size() - length + 1)), length,
                      static_cast<std::byte>(0xFF));
        }
    }
    const std::uint32_t kind = askBytes(kinds[which], payload);
    EXPECT_TRUE(kind >= 101 && kind <= 199) << kind;
    EXPECT_EQ(server_->ended(), kind == wire::Fault::kind);
  }
}

}  // namespace
}  // namespace calot::recorder
