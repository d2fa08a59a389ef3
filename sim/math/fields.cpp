// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/fields.h"

#define XXH_INLINE_ALL
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#endif
#include <xxhash.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace calot {

std::uint64_t digest64(std::span<const std::byte> bytes) { return XXH3_64bits(bytes.data(), bytes.size()); }

struct DigestStream::Storage {
  XXH3_state_t* state = XXH3_createState();
};

DigestStream::DigestStream() : storage_(new Storage) { reset(); }
DigestStream::~DigestStream() {
  XXH3_freeState(storage_->state);
  delete storage_;
}
void DigestStream::reset() { XXH3_64bits_reset(storage_->state); }
void DigestStream::append(const void* data, std::size_t size) { XXH3_64bits_update(storage_->state, data, size); }
std::uint64_t DigestStream::value() const { return XXH3_64bits_digest(storage_->state); }

}  // namespace calot
