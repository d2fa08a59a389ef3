// SPDX-License-Identifier: GPL-3.0-or-later
// Tables: the first byte says whether numbers, a column map, a motion by a map, or a table of people.
#include <array>
#include <string>

#include "recorder/base/csv.h"
#include "recorder/sources/tracked_motion.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  return fuzz::tried([&] {
    const std::uint8_t choice = fuzz::takeByte(bytes);
    static const std::array<std::string, 4> wanted{"t", "x", "y", "z"};
    if (choice % 4 == 0) {
      readCsvNumbers(bytes, "a.csv", choice % 8 == 0 ? ',' : ';', wanted);
    } else if (choice % 4 == 1) {
      recorder::parseColumnMap(bytes, "map.json");
    } else if (choice % 4 == 2) {
      recorder::ColumnMap map;
      map.frame = std::string("world");
      map.time = std::string("t");
      map.hand[0] = recorder::HandColumns{};
      map.hand[0]->position = {std::string("x"), std::string("y"), std::string("z")};
      recorder::parseCsvMotion(bytes, "a.csv", map);
    } else {
      parseCsvTable(fuzz::textOf(bytes), "people.csv");
    }
  });
}
