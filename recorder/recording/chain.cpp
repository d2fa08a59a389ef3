// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/chain.h"

#include <sodium.h>

#include "recorder/recording/header.h"

namespace calot::recorder {

namespace {

/// BLAKE2b-256 of what is appended; strings after their length (u32), numbers little-endian.
class Hash {
 public:
  Hash() {
    [[maybe_unused]] static const int ready = sodium_init();
    crypto_generichash_init(&state_, nullptr, 0, std::tuple_size_v<ChainHead>);
  }
  void bytes(const void* data, std::size_t size) {
    if (size > 0) crypto_generichash_update(&state_, static_cast<const unsigned char*>(data), size);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void number(T value) { bytes(&value, sizeof value); }
  void string(const std::string& text) {
    number(static_cast<std::uint32_t>(text.size()));
    bytes(text.data(), text.size());
  }
  ChainHead head() {
    ChainHead out{};
    crypto_generichash_final(&state_, out.data(), out.size());
    return out;
  }

 private:
  crypto_generichash_state state_;
};

struct HashAttributes {
  Hash& hash;
  void operator()(const char* name, const std::string& value) {
    hash.string(name);
    hash.string(value);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(const char* name, const T& value) {
    hash.string(name);
    hash.number(value);
  }
  template <class T>
  void constant(const char* name, const T& value) {
    (*this)(name, value);
  }
  template <class T, std::size_t N>
  void choice(const char* name, const T& value, const std::array<const char*, N>& names) {
    (*this)(name, std::string(names[static_cast<std::size_t>(value)]));
  }
};

void appendNames(Hash& hash, const std::vector<std::string>& names) {
  hash.number(static_cast<std::uint64_t>(names.size()));
  for (const std::string& name : names) hash.string(name);
}

void appendCounts(Hash& hash, const StatusRow& row) {
  hash.number(row.ticks);
  hash.number(row.steps);
  hash.number(row.events);
  hash.number(row.keyframes);
  hash.number(row.keyframeWords);
  hash.number(static_cast<std::uint8_t>(row.completed ? 1 : 0));
  hash.number(static_cast<std::uint8_t>(row.outcome));
}

}  // namespace

ChainHead chainStart(const AttemptHeader& header) {
  Hash hash;
  const std::string label = "calot-recording-chain-1";
  hash.bytes(label.data(), label.size());
  HashAttributes visit{hash};
  visitAttributes(header, visit);
  hash.number(static_cast<std::uint64_t>(header.assets.size()));
  for (const Asset& asset : header.assets) {
    hash.string(asset.name);
    hash.number(static_cast<std::uint64_t>(asset.bytes.size()));
    hash.bytes(asset.bytes.data(), asset.bytes.size());
  }
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if constexpr (Kind::hasStructures) {
      if (Kind::results.since <= header.stepResultVersion) appendNames(hash, Kind::namesOf(header));
    }
  });
  appendNames(hash, header.layout.components);
  hash.number(static_cast<std::uint64_t>(header.layout.fields.size()));
  for (const DigestLayout::Field& field : header.layout.fields) {
    hash.number(field.component);
    hash.string(field.name);
  }
  appendCounts(hash, StatusRow{});
  return hash.head();
}

ChainHead chainNext(const Layout& layout, const StatusRow& before, const Block& block, const StatusRow& after) {
  Hash hash;
  hash.bytes(before.chain.data(), before.chain.size());
  const std::array<std::uint64_t, streamCount> first = countsOf(before);
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    const Column& column = layout.columns[c];
    if (!column.chained || column.width == 0) continue;
    hash.string(column.path);
    const auto stream = static_cast<std::size_t>(column.stream);
    hash.number(first[stream]);
    hash.number(block.rows[stream]);
    hash.bytes(block.column[c].data(), block.column[c].size());
  }
  appendCounts(hash, after);
  return hash.head();
}

}  // namespace calot::recorder
