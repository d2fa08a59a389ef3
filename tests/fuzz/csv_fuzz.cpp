// SPDX-License-Identifier: GPL-3.0-or-later
// Tables: the first byte says whether a guess of columns, a column map, a motion by a map, or a table of people.
#include <string>

#include "recorder/base/csv.h"
#include "recorder/recording/demonstrations.h"
#include "recorder/sources/column_map.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  return fuzz::tried([&] {
    const std::uint8_t choice = fuzz::takeByte(bytes);
    if (recorder::isDemonstrations(fuzz::textOf(bytes))) return;  // HDF5 is read in a process of its own
    if (choice % 4 == 0) {
      const recorder::GuessedMap guess = recorder::guessColumns(bytes, "a.csv");
      if (guess.open.empty())
        recorder::parseCsvMotion(bytes, "a.csv",
                                 recorder::parseColumnMap(std::as_bytes(std::span(guess.json)), "map.json"));
    } else if (choice % 4 == 1) {
      recorder::parseColumnMap(bytes, "map.json");
    } else if (choice % 4 == 2) {
      recorder::ColumnMap map;
      map.dropsDisorder = choice % 8 == 2;
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
