// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/flat.h"

#include <array>

#include "sim/math/fields.h"

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

}  // namespace

std::vector<std::byte> saveFlat(const FlatState& flat) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  writer.write(magic);
  writer.write(flat.scene);
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
  reader.read(flat.scene);
  reader.read(flat.state);
  std::uint64_t ticks = 0;
  reader.read(ticks);
  if (!reader.ok() || ticks > bytes.size()) return false;
  flat.ticks.resize(static_cast<std::size_t>(ticks));
  for (TickSamples& tick : flat.ticks) visitTick(tick, reader);
  return reader.complete();
}

}  // namespace calot
