// SPDX-License-Identifier: GPL-3.0-or-later
// A cohort database, byte for byte: checked, then read.
#include "analytics/cohort/cohort_database.h"
#include "tests/fuzz/support/input_file.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  static const fuzz::InputFile file("database");
  file.write(bytes);
  return fuzz::tried([&] {
    const std::string path = file.path().string();
    analytics::checkCohort(path);
    const analytics::CohortDatabase cohort(path, analytics::CohortDatabase::Access::read);
    static_cast<void>(cohort.participants());
    static_cast<void>(cohort.listAttempts());
    static_cast<void>(cohort.allValues());
    static_cast<void>(cohort.norms());
    static_cast<void>(cohort.ratings());
  });
}
