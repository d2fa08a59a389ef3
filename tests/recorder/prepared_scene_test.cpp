// SPDX-License-Identifier: GPL-3.0-or-later
// What runs of a scene share changes nothing, wherever it comes from.
#include "recorder/prepared_scene.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "recorder/compliance_cache.h"
#include "recorder/replay.h"
#include "tests/recorder/support/lying_recording.h"
#include "tests/recorder/support/rerun.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

namespace fs = std::filesystem;

/// The process's cache while a test runs.
class PreparedScenes : public testing::Test {
 protected:
  PreparedScenes() { useComplianceCache(folder_ / "cache"); }
  ~PreparedScenes() override { useComplianceCache(std::nullopt); }

  /// As a program that begins anew would see it: the process still keeps the scenes that were asked for last.
  [[nodiscard]] std::shared_ptr<PreparedScene> prepared() const {
    return std::make_shared<PreparedScene>(assets_, Where{"test"});
  }

  /// Digests of the recorded touches, run with what a scene has at hand.
  std::vector<StateDigest> run(PreparedScene& scene, std::uint64_t steps = 80) {
    if (!fs::exists(folder_ / "r.h5")) test::recordTouches(folder_ / "r.h5");
    Recording recording(folder_ / "r.h5");
    SerialExecutor executor;
    Session session(scene.model(), recording.header().seed, executor, {.compliances = &scene.compliances()});
    session.precompute();
    std::vector<StateDigest> digests;
    while (session.steps() < steps) {
      test::rerun(session, recording.step(session.steps()));
      digests.push_back(digestOf(session.state()));
    }
    EXPECT_FALSE(scene.compliances().columns().empty()) << "nothing was touched";
    return digests;
  }

  [[nodiscard]] ComplianceCache cache() const { return ComplianceCache(folder_ / "cache"); }
  [[nodiscard]] fs::path entry() const { return cache().list().at(0).file; }

  test::Folder folder_;
  std::vector<Asset> assets_ = test::smallScene().assets;
};

std::string bytesOf(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void writeBytes(const fs::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary | std::ios::trunc) << bytes;
}

TEST_F(PreparedScenes, GiveTheSameBitsFromAnywhere) {
  const auto first = prepared();
  const std::vector<StateDigest> fresh = run(*first);
  EXPECT_EQ(fresh, run(*first)) << "columns of a session before";
  first->save();
  ASSERT_EQ(cache().list().size(), 1U);
  EXPECT_EQ(cache().list()[0].state, CacheEntry::State::usable);
  EXPECT_EQ(cache().list()[0].columns, first->compliances().columns().size());

  const auto second = prepared();
  EXPECT_EQ(fresh, run(*second)) << "columns of a file";
  EXPECT_FALSE(second->compliances().refuted());
  EXPECT_LT(second->compliances().computed(), first->compliances().computed() / 4);
}

TEST_F(PreparedScenes, AreBuiltOnce) {
  const auto one = prepareScene(assets_, Where{"a"});
  EXPECT_EQ(one, prepareScene(assets_, Where{"b"}));
  std::vector<Asset> other = assets_;
  other[1].name += "x";
  EXPECT_NE(complianceKey(assets_), complianceKey(other));
  expectFault(ErrorKind::damaged, "", {}, [&] { prepareScene(other, Where{"b"}); });
}

TEST_F(PreparedScenes, BelieveNoDamagedEntry) {
  const auto first = prepared();
  const std::vector<StateDigest> fresh = run(*first);
  first->save();
  const fs::path file = entry();
  const std::string whole = bytesOf(file);
  const std::size_t payload = whole.find('\n') + 1;
  std::vector<std::string> damaged{"", "{", whole.substr(0, whole.size() - 1), whole + "x", whole.substr(payload)};
  for (const std::size_t at : {std::size_t{3}, payload + 5, whole.size() / 2, whole.size() - 1}) {
    damaged.push_back(whole);
    damaged.back()[at] = static_cast<char>(damaged.back()[at] ^ 1);
  }
  for (std::size_t i = 0; i < damaged.size(); ++i) {
    SCOPED_TRACE(i);
    writeBytes(file, damaged[i]);
    EXPECT_TRUE(cache().load(complianceKey(assets_)).empty());
    EXPECT_EQ(cache().list()[0].state, CacheEntry::State::damaged);
  }
  const auto second = prepared();
  EXPECT_EQ(fresh, run(*second));
  EXPECT_EQ(second->compliances().computed(), first->compliances().computed());
  EXPECT_EQ(cache().clean(false).size(), 1U);
  EXPECT_TRUE(cache().list().empty());
}

/// Well-formed, of this key, and wrong: as a build with other sources might leave it.
TEST_F(PreparedScenes, FindOutWhatIsWrong) {
  const auto first = prepared();
  const std::vector<StateDigest> fresh = run(*first);
  std::vector<ComplianceColumn> columns = first->compliances().columns();
  for (ComplianceColumn& c : columns) {
    for (float& v : c.value) v *= 1.5F;
  }
  ASSERT_TRUE(cache().save(complianceKey(assets_), "small", columns));
  const auto second = prepared();
  EXPECT_EQ(fresh, run(*second));
  EXPECT_TRUE(second->compliances().refuted());
  EXPECT_EQ(second->compliances().computed(), first->compliances().computed());
}

TEST_F(PreparedScenes, BelieveNoForeignEntry) {
  const auto first = prepared();
  run(*first);
  first->save();
  const fs::path file = entry();
  ASSERT_EQ(chmod(file.c_str(), 0666), 0);
  EXPECT_TRUE(cache().load(complianceKey(assets_)).empty());
  EXPECT_EQ(cache().list()[0].state, CacheEntry::State::foreign);
  ASSERT_EQ(chmod(file.c_str(), 0600), 0);
  EXPECT_FALSE(cache().load(complianceKey(assets_)).empty());
  fs::rename(file, folder_ / "elsewhere");
  fs::create_symlink(folder_ / "elsewhere", file);
  EXPECT_TRUE(cache().load(complianceKey(assets_)).empty()) << "through a link";
}

TEST_F(PreparedScenes, WorkWithoutACache) {
  writeBytes(folder_ / "file", "no folder");
  useComplianceCache(folder_ / "file");
  const auto scene = prepared();
  run(*scene);
  EXPECT_NO_THROW(scene->save());
  EXPECT_EQ(bytesOf(folder_ / "file"), "no folder");
}

TEST_F(PreparedScenes, SaveNothingForAFewColumns) {
  const auto first = prepared();
  run(*first);
  first->save();
  const auto written = fs::last_write_time(entry());
  const auto second = prepared();
  run(*second);
  second->save();
  EXPECT_EQ(fs::last_write_time(entry()), written);
}

TEST(UserCacheFolder, IsTheOneThatIsNamed) {
  const auto with = [](const char* own, const char* base, const char* home) {
    setenv("CALOT_CACHE", own, 1);
    setenv("XDG_CACHE_HOME", base, 1);
    setenv("HOME", home, 1);
    return userCacheFolder();
  };
  const std::string home = std::getenv("HOME") == nullptr ? "" : std::getenv("HOME");
  EXPECT_EQ(with("/x", "/y", "/z"), fs::path("/x"));
  EXPECT_EQ(with("", "/y", "/z"), fs::path("/y/calot"));
  EXPECT_EQ(with("", "y", "/z"), fs::path("/z/.cache/calot"));
  EXPECT_EQ(with("", "", ""), std::nullopt);
  EXPECT_EQ(with("off", "/y", "/z"), std::nullopt);
  unsetenv("CALOT_CACHE");
  unsetenv("XDG_CACHE_HOME");
  setenv("HOME", home.c_str(), 1);
}

}  // namespace
}  // namespace calot::recorder
