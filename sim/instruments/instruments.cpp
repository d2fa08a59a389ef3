// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/instruments/instruments.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace calot {

constinit const InstrumentDefinition instrument::none{.name = "none", .word = "nothing"};

namespace {

#define CALOT_INSTRUMENT_ADDRESS(name, number) &instrument::name,
constexpr std::array mountable{CALOT_INSTRUMENTS(CALOT_INSTRUMENT_ADDRESS)};
#undef CALOT_INSTRUMENT_ADDRESS

/// Definitions by number; null where no instrument has it.
constexpr std::array<const InstrumentDefinition*, 256> byNumber = [] {
  std::array<const InstrumentDefinition*, 256> table{&instrument::none};
#define CALOT_INSTRUMENT_PLACE(name, number) table[number] = &instrument::name;
  CALOT_INSTRUMENTS(CALOT_INSTRUMENT_PLACE)
#undef CALOT_INSTRUMENT_PLACE
  return table;
}();

}  // namespace

std::span<const InstrumentDefinition* const> instruments() { return mountable; }

const InstrumentDefinition& instrumentOf(InstrumentKind kind) {
  const InstrumentDefinition* const known = byNumber[static_cast<std::size_t>(kind)];
  return known == nullptr ? instrument::none : *known;
}

const InstrumentDefinition* findInstrument(std::string_view name) {
  const auto* const found =
      std::find_if(mountable.begin(), mountable.end(), [name](const auto* each) { return each->name == name; });
  return found == mountable.end() ? nullptr : *found;
}

bool isInstrumentNumber(unsigned number) { return number < byNumber.size() && byNumber[number] != nullptr; }

}  // namespace calot
