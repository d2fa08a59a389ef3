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
#include <type_traits>
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

/// Visits a value in the protocol's form: an orientation as w, x, y, z, a flag as a byte (anything but 0 is true).
template <class T>
void visitOne(auto& visit, T& value) {
  using Value = std::remove_const_t<T>;
  if constexpr (std::is_same_v<Value, Quat>) {
    Rotation form{value.w(), value.x(), value.y(), value.z()};
    visit("", form);
    if constexpr (!std::is_const_v<T>) value = Quat(form[0], form[1], form[2], form[3]);
  } else if constexpr (std::is_same_v<Value, bool>) {
    auto form = static_cast<std::uint8_t>(value ? 1 : 0);
    visit("", form);
    if constexpr (!std::is_const_v<T>) value = form != 0;
  } else {
    visit("", value);
  }
}

/// Visits fields in their order, which is all that the protocol knows of them.
void visitAll(auto& visit, auto&... field) { (visitOne(visit, field), ...); }

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

/// A tick's inputs; of its outcome, which contact sets it uses and how late it ran.
struct Tick {
  TickSamples samples;
  TickOutcome logged;
  static void fields(auto& self, auto& visit) {
    for (std::size_t h = 0; h < handCount; ++h) {
      auto& hand = self.samples.hand[h];
      visitAll(visit, hand.position, hand.orientation, hand.jaw, hand.instrument, hand.buttons, hand.valid,
               self.logged.hand[h].contactSet);
    }
    visitAll(visit, self.samples.camera.position, self.samples.camera.orientation, self.logged.lateness);
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

struct Clip : ClipView {
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.pose.position, self.pose.orientation, self.width, self.legs, self.halfGap);
  }
};

struct Instrument : InstrumentView {
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.kind, self.pose.position, self.pose.orientation, self.port, self.radius, self.jaw,
             self.touching);
  }
};

struct View {
  static constexpr std::uint32_t kind = 107;
  std::uint64_t step = 0;
  double time = 0.0;
  std::vector<Surface> surface;
  std::vector<Bed> bed;
  std::vector<Clip> clip;
  std::array<Instrument, handCount> instrument;
  CameraSample camera;
  double fieldOfView = 0.0;
  static void fields(auto& self, auto& visit) {
    visitAll(visit, self.step, self.time, self.surface, self.bed, self.clip, self.instrument, self.camera.position,
             self.camera.orientation, self.fieldOfView);
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

/// @return false where something in it is no number, no rotation or no instrument that there is
bool isValid(const Tick& tick);

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
wire::Bytes encodePayload(const auto& payload) {
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

wire::Bytes encode(const auto& payload) {
  wire::Bytes bytes;
  appendMessage(payload, bytes);
  return bytes;
}

/// @return false where bytes are missing or left over
[[nodiscard]] bool decode(std::span<const std::byte> payload, auto& out) {
  ByteReader reader(payload);
  reader.read(out);
  return reader.complete();
}

}  // namespace calot::recorder
