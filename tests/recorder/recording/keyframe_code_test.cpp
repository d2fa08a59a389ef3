// SPDX-License-Identifier: GPL-3.0-or-later
// Keyframes as differences: what is coded comes back to the last byte, and no words make a reader stumble.
#include "recorder/recording/keyframe_code.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "sim/math/linear.h"
#include "sim/math/random.h"

namespace calot::recorder {
namespace {

using Words = std::vector<std::uint64_t>;
using Bytes = std::vector<std::byte>;

Bytes joined(const Keyframe& k) {
  Bytes bytes = k.state;
  bytes.insert(bytes.end(), k.haptics.begin(), k.haptics.end());
  return bytes;
}

/// Decodes a keyframe of a list by following its bases. @return empty and a failure where one is faulty
Bytes decoded(const std::vector<Words>& all, const std::vector<Keyframe>& made, std::size_t index, std::size_t& way) {
  ++way;
  const CodedKeyframe coded(all[index], index);
  EXPECT_EQ(coded.fault(), "");
  const Bytes base = coded.base() ? decoded(all, made, static_cast<std::size_t>(*coded.base()), way) : Bytes{};
  Bytes out;
  EXPECT_EQ(coded.decode(base, joined(made[index]).size(), out), "");
  return out;
}

/// Fields of any length, some of which change, grow, shrink or come anew from one keyframe to the next.
class Attempt {
 public:
  explicit Attempt(std::uint64_t seed) : random_(seed) {
    for (std::uint32_t n = 1 + random_.next() % 12; n > 0; --n) field_.emplace_back(random_.next() % 300);
  }
  Keyframe next() {
    for (Bytes& field : field_) {
      switch (random_.next() % 4) {
        case 0:
          field.resize(random_.next() % 300);
          break;
        case 1:
          for (std::byte& b : field) b = static_cast<std::byte>(random_.next());
          break;
        case 2:
          if (!field.empty()) field[random_.next() % field.size()] = static_cast<std::byte>(random_.next());
          break;
        default:
          break;
      }
    }
    if (random_.next() % 5 == 0) field_.emplace_back(random_.next() % 40);
    while (form_.size() < field_.size()) form_.push_back(random_.next() % 4);
    Keyframe k;
    k.step = step_++;
    const std::size_t haptic = random_.next() % (field_.size() + 1);
    for (std::size_t f = 0; f < field_.size(); ++f) {
      Bytes& to = f < haptic ? k.state : k.haptics;
      to.insert(to.end(), field_[f].begin(), field_[f].end());
      k.parts.push_back({static_cast<std::uint32_t>(field_[f].size()), static_cast<PartForm>(form_[f])});
    }
    if (random_.next() % 7 == 0) k.parts.clear();
    return k;
  }

 private:
  Random random_;
  std::uint64_t step_ = 0;
  std::vector<Bytes> field_;
  std::vector<std::uint32_t> form_;  // whatever the bytes are
};

TEST(KeyframeCode, GivesBackEveryByte) {
  constexpr std::uint64_t seed = 20260;
  std::printf("seeds from %llu on\n", static_cast<unsigned long long>(seed));
  for (std::uint64_t s = seed; s < seed + 60; ++s) {
    SCOPED_TRACE("seed " + std::to_string(s));
    Attempt attempt(s);
    KeyframeCoder coder;
    std::vector<Keyframe> made;
    std::vector<Words> coded;
    for (int i = 0; i < 40; ++i) {
      made.push_back(attempt.next());
      coded.push_back(coder.code(made.back()));
    }
    for (std::size_t i = 0; i < made.size(); ++i) {
      std::size_t way = 0;
      ASSERT_EQ(decoded(coded, made, i, way), joined(made[i])) << "keyframe " << i;
      EXPECT_LE(way, 10U);
    }
  }
}

TEST(KeyframeCode, BasesAreNearAndTheWayIsShort) {
  EXPECT_EQ(writtenBase(0), std::nullopt);
  EXPECT_EQ(writtenBase(1), 0U);
  EXPECT_EQ(writtenBase(3), 2U);
  EXPECT_EQ(writtenBase(4), 0U);
  EXPECT_EQ(writtenBase(8), 4U);
  EXPECT_EQ(writtenBase(16), 0U);
  EXPECT_EQ(writtenBase(27), 26U);
  for (std::uint64_t i = 0; i < 70000; ++i) {
    std::size_t way = 1;
    for (std::optional<std::uint64_t> at = writtenBase(i); at; at = writtenBase(*at)) ++way;
    ASSERT_LE(way, 28U) << i;  // 3 log4(70000) + 1, and far below the longest that is followed
  }
}

/// What did not change takes no words, whatever grew before it.
TEST(KeyframeCode, WhatDidNotChangeTakesNoWords) {
  Keyframe a;
  a.state.resize(8000);
  Random random(3);
  for (std::byte& b : a.state) b = static_cast<std::byte>(random.next());
  a.parts = {{800}, {3200}, {4000}};
  Keyframe b = a;
  b.state.insert(b.state.begin() + 800, 160, std::byte{7});  // the first field grows by 20 words
  b.parts[0].bytes += 160;
  KeyframeCoder coder;
  coder.code(a);
  const Words words = coder.code(b);
  EXPECT_LE(words.size(), 2U + 3U * 4U + 20U);
}

TEST(KeyframeCode, SmallDifferencesOfEitherSignAreSmallNumbers) {
  const auto frame = [](std::uint64_t value) {
    Keyframe k;
    k.state.resize(8);
    std::memcpy(k.state.data(), &value, 8);
    k.parts = {{8}};
    return k;
  };
  KeyframeCoder coder;
  coder.code(frame(100));
  EXPECT_EQ(coder.code(frame(97)).back(), 5U);
  EXPECT_EQ(coder.code(frame(99)).back(), 4U);
}

/// Unit quaternions and symmetric matrices store what does not follow: the last bits of the rest.
TEST(KeyframeCode, WhatFollowsFromTheRestIsNearlyZero) {
  Random random(8);
  const auto code = [&](PartForm form, const std::vector<double>& values) {
    Keyframe k;
    const auto count = static_cast<std::uint64_t>(values.size());
    k.state.resize(8 + values.size() * 8);
    std::memcpy(k.state.data(), &count, 8);
    std::memcpy(k.state.data() + 8, values.data(), values.size() * 8);
    k.parts = {{static_cast<std::uint32_t>(k.state.size()), form}};
    KeyframeCoder coder;
    const Words words = coder.code(k);
    Bytes out;
    EXPECT_EQ(CodedKeyframe(words, 0).decode({}, k.state.size(), out), "");
    EXPECT_EQ(out, k.state);
    return words;
  };
  const auto small = [](const Words& words) {
    return std::count_if(words.end() - 64, words.end(), [](std::uint64_t w) { return w < 64; });
  };
  std::vector<double> list(64), lanes(64), matrix(64);
  for (std::size_t i = 0; i < 16; ++i) {
    Quat q(2.0, random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    q.normalize();
    const std::array xyzw{q.x(), q.y(), q.z(), q.w()};
    const std::array wxyz{q.w(), q.x(), q.y(), q.z()};
    for (std::size_t c = 0; c < 4; ++c) {
      list[4 * i + c] = xyzw[c];
      lanes[i / 8 * 32 + c * 8 + i % 8] = wxyz[c];
    }
  }
  for (std::size_t r = 0; r < 8; ++r)
    for (std::size_t c = r; c < 8; ++c) matrix[8 * r + c] = matrix[8 * c + r] = random.uniform(0.1, 1.0);
  EXPECT_EQ(small(code(PartForm::quaternions, list)), 16);
  EXPECT_EQ(small(code(PartForm::quaternionsByLane, lanes)), 16);
  EXPECT_EQ(small(code(PartForm::symmetricMatrix, matrix)), 28);
  EXPECT_EQ(small(code(PartForm::plain, list)), 0);
}

TEST(KeyframeCode, RefusesWhatDoesNotAddUp) {
  const Bytes base(64);
  Bytes out;
  const auto fault = [&](Words words, std::uint64_t size, std::uint64_t index = 1) {
    const CodedKeyframe coded(words, index);
    return coded.fault().empty() ? coded.decode(base, size, out) : coded.fault();
  };
  constexpr std::uint64_t huge = ~std::uint64_t{0};
  EXPECT_EQ(fault({1, 1, 16, 8, 16, 0, 0, 0}, 16), "");
  EXPECT_EQ(fault({1, 1, 16, 8, 16, 3, 0, 0}, 16), "");
  EXPECT_EQ(fault({1, 1, 16, 8, 16, 4}, 16), "");
  EXPECT_NE(fault({1, 1, 16, 8, 8, 4}, 16), "") << "unchanged from less than it has";
  EXPECT_NE(fault({1, 1, 16, 8, 16, 5, 0, 0}, 16), "") << "no such form";
  EXPECT_NE(fault({1, 3, 64, 0, 64, 4, 64, 0, 64, 4, 64, 0, 64, 4}, 192), "") << "the base three times over";
  EXPECT_NE(fault({}, 0), "");
  EXPECT_NE(fault({0}, 0), "");
  EXPECT_NE(fault({2, 1, 16, 8, 16, 0, 0, 0}, 16), "") << "its own base";
  EXPECT_NE(fault({huge, 1, 16, 8, 16, 0, 0, 0}, 16), "");
  EXPECT_NE(fault({1, huge, 16, 8, 16, 0, 0, 0}, 16), "");
  EXPECT_NE(fault({1, huge / 4 + 1, 16, 8, 16, 0, 0, 0}, 16), "") << "4 times as many words overflow";
  EXPECT_NE(fault({1, 2, 16, 8, 16, 0, 0, 0}, 16), "") << "a part that is not there";
  EXPECT_NE(fault({1, 1, 16, 8, 16, 0, 0, 0}, 17), "") << "more bytes than parts";
  EXPECT_NE(fault({1, 1, 16, 8, 16, 0, 0, 0}, huge), "");
  EXPECT_NE(fault({1, 1, 8, 8, 8, 0, 0, 0}, 16), "") << "parts of too few bytes";
  EXPECT_NE(fault({1, 1, 24, 8, 16, 0, 0, 0, 0}, 16), "") << "of too many";
  EXPECT_NE(fault({1, 1, huge, 8, 16, 0, 0, 0}, 16), "");
  EXPECT_NE(fault({1, 1, 16, 56, 16, 0, 0, 0}, 16), "") << "past the base's end";
  EXPECT_NE(fault({1, 1, 16, huge, 16, 0, 0, 0}, 16), "");
  EXPECT_NE(fault({1, 1, 16, 0, 17, 0, 0, 0}, 16), "") << "like more than it has";
  EXPECT_NE(fault({1, 2, 12, 0, 0, 0, 4, 0, 0, 0, 0}, 16), "") << "two parts need two words";
}

TEST(KeyframeCode, NoWordsMakeItStumble) {
  constexpr std::uint64_t seed = 77;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  Random random(seed);
  const auto wide = [&] { return (static_cast<std::uint64_t>(random.next()) << 32U) | random.next(); };
  Attempt attempt(seed);
  KeyframeCoder coder;
  const Bytes base = joined(attempt.next());
  for (int i = 0; i < 1500; ++i) {
    const Keyframe good = attempt.next();
    Words words = coder.code(good);
    for (std::uint32_t n = 1 + random.next() % 4; n > 0; --n) {
      const std::size_t at = random.next() % std::min<std::size_t>(words.size(), 12);
      words[at] = random.next() % 2 == 0 ? wide() : random.next() % 400;
    }
    if (random.next() % 4 == 0) words.resize(random.next() % (words.size() + 1));
    const CodedKeyframe coded(words, 5);
    if (!coded.fault().empty()) continue;
    Bytes out;
    const std::size_t size = joined(good).size();
    const bool whole = coded.decode(base, size, out).empty();
    EXPECT_TRUE(!whole || out.size() == size);
    EXPECT_LE(out.size(), size);
  }
}

}  // namespace
}  // namespace calot::recorder
