// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/station_key.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

class StationKeys : public ::testing::Test {
 protected:
  StationKeys() {
    std::string pattern = (std::filesystem::temp_directory_path() / "calot-key-XXXXXX").string();
    folder_ = ::mkdtemp(pattern.data());
  }
  ~StationKeys() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  std::filesystem::path folder_;
};

// RFC 8032, 7.1, test 1: the public key that belongs to a seed.
TEST_F(StationKeys, publicKeyIsThatOfTheStandard) {
  const std::filesystem::path file = folder_ / "k.json";
  std::ofstream(file) << R"({"format": "calot-station-key", "version": 1, "station": "S",
    "public_key": "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a",
    "seed": "9d61b19deffd5a60ba844af492ec2cc44449c5697b326919703bac031cae7f60"})";
  ::chmod(file.c_str(), 0600);
  const StationKey key = readStationKey(file);
  EXPECT_EQ(key.station, "S");
  EXPECT_EQ(key.publicKey[0], 0xD7);
  EXPECT_EQ(key.publicKey[31], 0x1A);
}

TEST_F(StationKeys, signsWhatNoChangedBitPasses) {
  const std::filesystem::path file = folder_ / "k.json";
  writeStationKey(file, makeStationKey("OR 3"));
  const StationKey key = readStationKey(file);
  EXPECT_EQ(key.station, "OR 3");
  const unsigned seed = 77;
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::array<std::uint8_t, 32> head{};
  for (auto& byte : head) byte = static_cast<std::uint8_t>(random());
  const Signature signature = signHead(key, head);
  EXPECT_EQ(signHead(key, head), signature) << "Ed25519 draws no random numbers";
  EXPECT_TRUE(fits(signature, key.publicKey, head));
  for (int i = 0; i < 300; ++i) {
    auto otherHead = head;
    auto otherSignature = signature;
    auto otherKey = key.publicKey;
    const auto bit = static_cast<std::uint8_t>(1U << random() % 8);
    switch (i % 3) {
      case 0:
        otherHead[random() % otherHead.size()] ^= bit;
        break;
      case 1:
        otherSignature[random() % otherSignature.size()] ^= bit;
        break;
      default:
        otherKey[random() % otherKey.size()] ^= bit;
    }
    EXPECT_FALSE(fits(otherSignature, otherKey, otherHead));
  }
  EXPECT_FALSE(fits(Signature{}, PublicKey{}, std::array<std::uint8_t, 32>{})) << "nothing is no signature";
}

TEST_F(StationKeys, areNotReplacedNorReadByOthers) {
  const std::filesystem::path file = folder_ / "k.json";
  writeStationKey(file, makeStationKey("S"));
  EXPECT_THROW(writeStationKey(file, makeStationKey("S")), Error);
  struct stat status {};
  ASSERT_EQ(::stat(file.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  ::chmod(file.c_str(), 0604);
  EXPECT_THROW(readStationKey(file), Error);
  EXPECT_THROW(makeStationKey(""), Error);
  EXPECT_THROW(makeStationKey(std::string(65, 'x')), Error);
}

}  // namespace
}  // namespace calot::recorder
