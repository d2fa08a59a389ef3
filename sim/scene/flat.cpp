// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/flat.h"

#include <array>
#include <string>
#include <type_traits>

#include "sim/math/fields.h"
#include "sim/math/record.h"

namespace calot {

namespace {

constexpr std::array<char, 8> magic{'C', 'A', 'L', 'O', 'T', 'F', 'L', '2'};

template <class Tick, class Visitor>
void visitTick(Tick& tick, Visitor& visit) {
  for (auto& hand : tick.hand) {
    visit("position", hand.position);
    visit("orientation", hand.orientation);
    visit("jaw", hand.jaw);
    visit("instrument", hand.instrument);
    visit("buttons", hand.buttons);
    visit("valid", hand.valid);
  }
  visit("cameraPosition", tick.camera.position);
  visit("cameraOrientation", tick.camera.orientation);
}

template <class Stream>
void visitRecord(Stream& stream, const Record& record, void* object);

template <class Stream>
void visitValue(Stream& stream, const Access& access, void* value) {
  constexpr bool reads = std::is_same_v<Stream, ByteReader>;
  if (access.type == Access::Type::record) {
    visitRecord(stream, access.record(), value);
  } else if (access.type == Access::Type::text) {
    stream("", *static_cast<std::string*>(value));
  } else if (access.type == Access::Type::list) {
    const bool grows = access.append != nullptr;
    std::uint64_t items = access.items(value);
    if (grows) stream("", items);
    for (std::size_t i = 0; i < items; ++i) {
      if constexpr (reads) {
        if (!stream.ok()) return;
      }
      visitValue(stream, *access.item, reads && grows ? access.append(value) : access.itemAt(value, i));
    }
  } else {
    for (std::size_t i = 0; i < access.size; ++i) stream("", static_cast<std::byte*>(value)[i]);
  }
}

template <class Stream>
void visitRecord(Stream& stream, const Record& record, void* object) {
  for (const Field& field : record.fields) {
    if (field.value.get != nullptr) visitValue(stream, field.value, field.value.get(object));
  }
}

}  // namespace

std::vector<std::byte> saveFlat(const FlatState& flat) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  writer.write(magic);
  SceneDescription scene = flat.scene;
  visitRecord(writer, recordOf<SceneDescription>(), &scene);
  writer.write(flat.state);
  writer.write(static_cast<std::uint64_t>(flat.ticks.size()));
  for (const TickSamples& tick : flat.ticks) visitTick(tick, writer);
  return bytes;
}

bool loadFlat(std::span<const std::byte> bytes, FlatState& flat) {
  ByteReader reader(bytes);
  std::array<char, 8> found{};
  reader.read(found);
  if (!reader.ok() || found != magic) return false;
  flat.scene = {};
  visitRecord(reader, recordOf<SceneDescription>(), &flat.scene);
  reader.read(flat.state);
  std::uint64_t ticks = 0;
  reader.read(ticks);
  if (!reader.ok() || ticks > bytes.size()) return false;
  flat.ticks.resize(static_cast<std::size_t>(ticks));
  for (TickSamples& tick : flat.ticks) visitTick(tick, reader);
  return reader.complete();
}

}  // namespace calot
