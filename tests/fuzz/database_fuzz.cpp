// SPDX-License-Identifier: GPL-3.0-or-later
// A cohort database, byte for byte but for the checksums of its pages, which are made to fit: checked, then read.
#include <sodium.h>

#include <array>
#include <cstring>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "tests/fuzz/support/input_file.h"

#include "tests/fuzz/support/fuzz_target.h"

using namespace calot;

namespace {

/// docs/reference/cohort.md, "Pages"
std::vector<std::uint8_t> withSums(std::vector<std::uint8_t> file) {
  if (file.size() < 100) return file;
  const std::size_t page = file[16] == 0 && file[17] == 1 ? 65536 : static_cast<std::size_t>(file[16] << 8 | file[17]);
  if (page < 512) return file;
  file[20] = 8;
  for (std::size_t at = 0; at + page <= file.size(); at += page) {
    std::vector<std::uint8_t> hashed(file.begin() + static_cast<std::ptrdiff_t>(at),
                                     file.begin() + static_cast<std::ptrdiff_t>(at + page - 8));
    for (unsigned i = 0; i < 4; ++i) hashed.push_back(static_cast<std::uint8_t>((at / page + 1) >> 8 * i));
    std::array<std::uint8_t, 16> digest{};
    crypto_generichash(digest.data(), digest.size(), hashed.data(), hashed.size(), nullptr, 0);
    std::memcpy(&file[at + page - 8], digest.data(), 8);
  }
  return file;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::vector<std::uint8_t> sealed = withSums({data, data + size});
  const std::span bytes = std::as_bytes(std::span(sealed));
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
