// SPDX-License-Identifier: GPL-3.0-or-later
// The payloads of an engine's protocol (schemas/engine.md, which comes first): each lists its fields once, in their
// order, and is written and read by that list (sim/math/fields.h). A message is kind, length and payload.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "recorder/engine/observer.h"
#include "sim/math/fields.h"
#include "sim/scene/scene_view.h"

namespace calot::recorder::wire {

inline constexpr std::array<char, 8> magic{'C', 'A', 'L', 'O', 'T', 'E', 'N', 'G'};
inline constexpr std::uint32_t protocol = 1;

using Bytes = std::vector<std::byte>;
/// w, x, y, z.
using Rotation = std::array<double, 4>;

/// Parts that a step's result shall include.
inline constexpr std::uint8_t wantKeyframe = 1U << 0U;
inline constexpr std::uint8_t wantContactSets = 1U << 1U;
inline constexpr std::uint8_t wantView = 1U << 2U;
inline constexpr std::uint8_t wantAll = wantKeyframe | wantContactSets | wantView;

enum class FaultCode : std::uint32_t { message = 1, protocol = 2, scene = 3, contactSet = 4, other = 5 };

/// Visits fields in their order, which is all that the protocol knows of them.
void visitAll(auto& visit, auto&... field) { (visit("", field), ...); }

// Requests

struct Hello {
  static constexpr std::uint32_t kind = 1;
  std::array<char, 8> magic = wire::magic;
  std::uint32_t protocol = wire::protocol;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.magic, self.protocol); }
};

struct File {
  std::string name;
  Bytes content;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.name, self.content); }
};

struct Scene {
  static constexpr std::uint32_t kind = 2;
  std::vector<File> files;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.files); }
};

struct Start {
  static constexpr std::uint32_t kind = 3;
  std::uint64_t seed = 0;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.seed); }
};

struct Keyframe : recorder::Keyframe {
  static constexpr std::uint32_t kind = 106;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.step, self.state, self.haptics); }
};

struct Restore {
  static constexpr std::uint32_t kind = 4;
  Keyframe keyframe;
  std::uint8_t known = 0;
  std::array<std::int64_t, 2> named{-1, -1};
  static void fields(auto& self, auto& visit) { visitAll(visit, self.keyframe, self.known, self.named); }
};

struct HandSample {
  Vec3 position = Vec3::Zero();
  Rotation orientation{1.0, 0.0, 0.0, 0.0};
  double jaw = 0.0;
  std::uint8_t instrument = 0, buttons = 0, valid = 1;
  std::int64_t set = -1;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.position, self.orientation, self.jaw, self.instrument, self.buttons, self.valid, self.set);
  }
};

struct Tick {
  std::array<HandSample, 2> hand;
  Vec3 cameraPosition = Vec3::Zero();
  Rotation cameraOrientation{1.0, 0.0, 0.0, 0.0};
  float lateness = 0.0F;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.hand, self.cameraPosition, self.cameraOrientation, self.lateness);
  }
};

struct Step {
  static constexpr std::uint32_t kind = 5;
  std::uint8_t wanted = 0;
  float lateness = 0.0F;
  std::vector<Tick> ticks;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.wanted, self.lateness, self.ticks); }
};

struct AskKeyframe {
  static constexpr std::uint32_t kind = 6;
  static void fields(auto& /*self*/, auto& /*visit*/) {}
};

struct AskView {
  static constexpr std::uint32_t kind = 7;
  static void fields(auto& /*self*/, auto& /*visit*/) {}
};

struct Explain {
  static constexpr std::uint32_t kind = 8;
  Keyframe keyframe;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.keyframe); }
};

// Answers

struct IsHello {
  static constexpr std::uint32_t kind = 101;
  std::array<char, 8> magic = wire::magic;
  std::uint32_t protocol = wire::protocol;
  std::uint32_t simulation = 0, result = 0;
  std::string software;
  std::uint8_t confined = 0;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.magic, self.protocol, self.simulation, self.result, self.software, self.confined);
  }
};

struct Field {
  std::uint32_t component = 0;
  std::string name;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.component, self.name); }
};

struct Column {
  std::string path, type;
  std::uint32_t width = 0;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.path, self.type, self.width); }
  bool operator==(const Column&) const = default;
};

struct IsScene {
  static constexpr std::uint32_t kind = 102;
  std::uint32_t ticks = 0;
  double tick = 0.0;
  std::vector<std::string> components;
  std::vector<Field> digested;
  std::vector<std::string> structures;
  std::vector<Column> columns;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.ticks, self.tick, self.components, self.digested, self.structures, self.columns);
  }
};

struct IsReady {
  static constexpr std::uint32_t kind = 103;
  std::uint64_t steps = 0;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.steps); }
};

struct IsRefused {
  static constexpr std::uint32_t kind = 104;
  std::string why;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.why); }
};

struct Event {
  std::uint64_t step = 0;
  std::uint8_t event = 0, hand = 255;
  std::uint16_t subject = 0;
  Vec3 position = Vec3::Zero();
  double value = 0.0;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.step, self.event, self.hand, self.subject, self.position, self.value);
  }
};

struct IsStep {
  static constexpr std::uint32_t kind = 105;
  std::uint64_t step = 0;
  std::vector<std::array<Vec3, 4>> forces;  ///< left force, left torque, right force, right torque
  std::vector<std::uint64_t> components;
  std::vector<std::uint32_t> digested;
  std::vector<Event> events;
  Bytes results, keyframe, sets, view;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.step, self.forces, self.components, self.digested, self.events, self.results, self.keyframe,
             self.sets, self.view);
  }
};

struct Surface : SurfaceView {
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.organ, self.appearance, self.role, self.position, self.rest, self.triangle, self.charred,
             self.face);
  }
};

struct Bed : ConnectiveView {
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.name, self.strand, self.condition, self.alpha, self.sheet);
  }
};

struct Clip {
  Vec3 position = Vec3::Zero();
  Rotation orientation{1.0, 0.0, 0.0, 0.0};
  double width = 0.0, legs = 0.0, halfGap = 0.0;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.position, self.orientation, self.width, self.legs, self.halfGap);
  }
};

struct Instrument {
  std::uint8_t instrument = 0;
  Vec3 position = Vec3::Zero();
  Rotation orientation{1.0, 0.0, 0.0, 0.0};
  Vec3 port = Vec3::Zero();
  double radius = 0.0, jaw = 0.0;
  std::uint8_t touching = 0;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.instrument, self.position, self.orientation, self.port, self.radius, self.jaw, self.touching);
  }
};

struct View {
  static constexpr std::uint32_t kind = 107;
  std::uint64_t step = 0;
  double time = 0.0;
  std::vector<Surface> surface;
  std::vector<Bed> bed;
  std::vector<Clip> clip;
  std::array<Instrument, 2> instrument;
  Vec3 cameraPosition = Vec3::Zero();
  Rotation cameraOrientation{1.0, 0.0, 0.0, 0.0};
  double fieldOfView = 0.0;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.step, self.time, self.surface, self.bed, self.clip, self.instrument, self.cameraPosition,
             self.cameraOrientation, self.fieldOfView);
  }
};

struct IsExplained {
  static constexpr std::uint32_t kind = 108;
  std::uint8_t differs = 0;
  std::string field, detail;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.differs, self.field, self.detail); }
};

struct Fault {
  static constexpr std::uint32_t kind = 199;
  FaultCode code = FaultCode::other;
  std::string message;
  static void fields(auto& self, auto& visit) { visitAll(visit, self.code, self.message); }
};

// Samples, events, keyframes and scene views in the protocol's form, and back.

/// The ticks of a step's request, into memory that is used again. @param logged names contact sets, and how late each
/// tick ran @pre as many outcomes as samples
void toWire(std::span<const TickSamples> samples, std::span<const TickOutcome> logged, std::vector<Tick>& out);
/// @return false where something in it is no number, no rotation or no instrument that there is
bool fromWire(const Tick& tick, TickSamples& samples, TickOutcome& logged);

Event toWire(const calot::Event& event);
calot::Event fromWire(const Event& event);

/// Without its parts, of which the protocol knows nothing.
inline Keyframe toWire(const recorder::Keyframe& keyframe) {
  return {{keyframe.step, keyframe.state, keyframe.haptics}};
}

View toWire(const SceneView& view);
/// @return false where its lists do not fit one another
bool fromWire(View view, SceneView& out);

}  // namespace calot::recorder::wire

namespace calot::recorder {

/// Bytes that a message's payload may have.
inline constexpr std::uint64_t maxPayload = std::uint64_t{1} << 30U;
/// kind (u4) and length (u8)
inline constexpr std::size_t messageHead = 12;

struct MessageHead {
  std::uint32_t kind = 0;
  std::uint64_t length = 0;
};

/// @pre messageHead bytes
inline MessageHead parseHead(std::span<const std::byte> bytes) {
  MessageHead head;
  std::memcpy(&head.kind, bytes.data(), sizeof head.kind);
  std::memcpy(&head.length, bytes.data() + sizeof head.kind, sizeof head.length);
  return head;
}

/// A payload alone.
template <class Payload>
wire::Bytes encodePayload(const Payload& payload) {
  wire::Bytes bytes;
  ByteWriter(bytes).write(payload);
  return bytes;
}

/// Appends a whole message.
template <class Payload>
void appendMessage(const Payload& payload, wire::Bytes& out) {
  const std::size_t at = out.size();
  ByteWriter writer(out);
  writer.write(Payload::kind);
  writer.write(std::uint64_t{0});
  writer.write(payload);
  const std::uint64_t length = out.size() - at - messageHead;
  std::memcpy(out.data() + at + sizeof(std::uint32_t), &length, sizeof length);
}

template <class Payload>
wire::Bytes encode(const Payload& payload) {
  wire::Bytes bytes;
  appendMessage(payload, bytes);
  return bytes;
}

/// @return false where bytes are missing or left over
template <class Payload>
[[nodiscard]] bool decode(std::span<const std::byte> payload, Payload& out) {
  ByteReader reader(payload);
  reader.read(out);
  return reader.complete();
}

}  // namespace calot::recorder
