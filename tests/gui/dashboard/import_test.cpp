// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/dashboard/import_queue.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <QDir>
#include <QFile>
#include <QTemporaryDir>
#include <QTest>
#include <vector>

#include "analytics/checkpoints/collector.h"
#include "apps/calot-dashboard/assess_program.h"
#include "gui/attempt/stretch_figures.h"
#include "gui/dashboard/cohort_document.h"
#include "recorder/recording/reader.h"
#include "tests/gui/dashboard/support/recorded.h"
#include "tests/support/message.h"

namespace calot::gui {
namespace {

using Kind = ImportResult::Kind;

TEST(ImportResult, OfAVerifiedRecordingSaysWhetherItIsNew) {
  const auto textOf = [](const QByteArray& stored) {
    const ImportResult result = importResultOf(
        apps::assessProgram(), "a.h5", 0, false,
        "{\"recordings\": [{\"verdict\": \"bit-exact\", \"message\": \"\", \"stored\": \"" + stored + "\"}]}", "");
    EXPECT_EQ(result.kind, Kind::stored);
    return result.text;
  };
  std::vector<std::string> texts;
  for (const char* stored : {"added", "unchanged", "extended"}) {
    texts.push_back(textOf(stored).toStdString());
    expectNames(texts.back(), {"✓ verified; "});
  }
  expectDistinct(texts);
}

TEST(ImportResult, OfADivergedOneSaysWhatWasFound) {
  const ImportResult result = importResultOf(
      apps::assessProgram(), "a.h5", 3, false,
      R"({"recordings": [{"verdict": "diverged", "message": "diverged at step 13", "stored": "added"}]})", "");
  EXPECT_EQ(result.kind, Kind::stored) << "it is an attempt of the cohort all the same";
  expectNames(result.text.toStdString(), {"≠ diverged: ", "step 13"});
}

TEST(ImportResult, OfADamagedOneIsRefused) {
  const ImportResult result =
      importResultOf(apps::assessProgram(), "a.h5", 4, false,
                     R"({"recordings": [{"verdict": "damaged", "message": "short", "stored": "not stored"}]})", "");
  EXPECT_EQ(result.kind, Kind::refused);
  expectNames(result.text.toStdString(), {"✕ damaged: short; "});
}

TEST(ImportResult, WithoutAReportIsTheLastLineOfTheErrors) {
  const ImportResult refused =
      importResultOf(apps::assessProgram(), "a.h5", 4, false, "", "calot: warning: slow\ncalot: c.db: corrupt\n");
  EXPECT_EQ(refused.kind, Kind::refused);
  EXPECT_EQ(refused.text, "calot: c.db: corrupt");
  for (const QByteArray output :
       {"", "[]", "{}", "[1]", "{\"recordings\": 1}", "{\"recordings\": []}", "no JSON", "[{\"verdict\": "}) {
    const ImportResult failed = importResultOf(apps::assessProgram(), "a.h5", 1, false, output, "");
    EXPECT_EQ(failed.kind, Kind::failed);
    expectNames(failed.text.toStdString(), {"1"});
  }
}

TEST(ImportResult, OfACrashIsAFailureWhateverWasPrinted) {
  const ImportResult result =
      importResultOf(apps::assessProgram(), "a.h5", 0, true,
                     R"({"recordings": [{"verdict": "bit-exact", "message": "", "stored": "added"}]})", "");
  EXPECT_EQ(result.kind, Kind::failed);
}

class Import : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { test::startApplication(); }

  /// A program that does what the script says, in the place of calot: $2 is the recording, $4 the database.
  QString program(const QByteArray& script) {
    const QString path = folder_.filePath("program.sh");
    QFile file(path);
    EXPECT_TRUE(file.open(QIODevice::WriteOnly));
    file.write("#!/bin/sh\n" + script);
    file.close();
    file.setPermissions(QFile::ReadOwner | QFile::WriteOwner | QFile::ExeOwner);
    return path;
  }
  std::vector<ImportResult> run(const QString& program, const QStringList& files) {
    ImportQueue queue(apps::assessProgram());
    std::vector<ImportResult> results;
    QObject::connect(&queue, &ImportQueue::fileDone, [&](const ImportResult& r) { results.push_back(r); });
    bool done = false;
    QObject::connect(&queue, &ImportQueue::allDone, [&] { done = true; });
    queue.configure(program, folder_.filePath("c.db"), 1);
    queue.add(files);
    EXPECT_TRUE(QTest::qWaitFor([&] { return done; }, 60000));
    EXPECT_EQ(queue.done(), queue.total());
    EXPECT_FALSE(queue.busy());
    return results;
  }

  QTemporaryDir folder_;
};

TEST_F(Import, AFileThatKillsTheProgramHarmsNoOther) {
  const std::vector<ImportResult> results = run(
      program("case $2 in *hostile*) kill -SEGV $$;; esac\n"
              "echo '{\"recordings\": [{\"verdict\": \"bit-exact\", \"message\": \"\", \"stored\": \"added\"}]}'\n"),
      {"one.h5", "hostile.h5", "two.h5"});
  ASSERT_EQ(results.size(), 3U);
  EXPECT_EQ(results[0].kind, Kind::stored);
  EXPECT_EQ(results[1].kind, Kind::failed);
  EXPECT_EQ(results[1].file, "hostile.h5");
  EXPECT_EQ(results[2].kind, Kind::stored);
}

TEST_F(Import, TellsTheProgramFileAndDatabase) {
  const std::vector<ImportResult> results = run(program("echo \"$@\" >&2\nexit 1\n"), {"-rf.h5"});
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].text,
            "assess " + QDir::currentPath() + "/-rf.h5 --cohort " + folder_.filePath("c.db") + " --threads 1 --json");
}

TEST_F(Import, AProgramThatIsNotThereIsSaidForEachFile) {
  const std::vector<ImportResult> results = run(folder_.filePath("nowhere"), {"one.h5", "two.h5"});
  ASSERT_EQ(results.size(), 2U);
  EXPECT_TRUE(results[1].text.contains("Settings")) << results[1].text.toStdString();
}

TEST_F(Import, StoppingEndsAProgramThatHangsAndDropsTheRest) {
  ImportQueue queue(apps::assessProgram());
  std::vector<ImportResult> results;
  bool done = false;
  QObject::connect(&queue, &ImportQueue::fileDone, [&](const ImportResult& r) { results.push_back(r); });
  QObject::connect(&queue, &ImportQueue::allDone, [&] { done = true; });
  queue.configure(program("exec sleep 600\n"), folder_.filePath("c.db"), 1);
  queue.add({"one.h5", "two.h5", "three.h5"});
  EXPECT_TRUE(queue.busy());
  QTest::qWait(50);
  queue.cancel();
  ASSERT_TRUE(QTest::qWaitFor([&] { return done; }, 20000));
  ASSERT_EQ(results.size(), 1U);
  EXPECT_EQ(results[0].text, "stopped");
  EXPECT_EQ(queue.total(), 1);
}

TEST_F(Import, ABranchIsMadeByAPerformerThenAssessedAndComparedFromWhereItParts) {
  const std::filesystem::path root = folder_.path().toStdString();
  const std::string parent = test::recordPerformer(root / "one.h5", 1.0);
  ImportQueue queue(apps::assessProgram());
  std::vector<ImportResult> results;
  bool done = false;
  QObject::connect(&queue, &ImportQueue::fileDone, [&](const ImportResult& r) { results.push_back(r); });
  QObject::connect(&queue, &ImportQueue::allDone, [&] { done = true; });
  queue.configure(CALOT_PROGRAM, folder_.filePath("c.db"), 1);
  const QString recording = folder_.filePath("one.h5");
  const QString file = branchFile(recording, "skilled", 0.5);
  EXPECT_EQ(file, folder_.filePath("one-skilled-from-0.5.h5"));
  queue.addBranch({recording, 0.5, "skilled", 1, file});
  queue.addBranch({folder_.filePath("gone.h5"), 0.5, "skilled", 1, folder_.filePath("none.h5")});
  EXPECT_TRUE(queue.making());
  ASSERT_TRUE(QTest::qWaitFor([&] { return done; }, 60000));
  ASSERT_EQ(results.size(), 2U);
  EXPECT_EQ(results[0].kind, Kind::stored) << results[0].text.toStdString();
  EXPECT_EQ(results[1].kind, Kind::failed);
  expectHolds(results[1].text.toStdString(), {"gone.h5"});
  EXPECT_NE(branchFile(recording, "skilled", 0.5), file) << "that name is taken";

  const CohortDocument document(folder_.filePath("c.db").toStdString());
  ASSERT_EQ(document.attempts().size(), 1U);
  EXPECT_EQ(document.attempts()[0].parent, parent);
  EXPECT_TRUE(document.attempts()[0].synthetic);
  recorder::Recording before(root / "one.h5"), branch(file.toStdString());
  const AttemptTrack a = readTrack(before), b = readTrack(branch);
  ASSERT_TRUE(partingTime(a, b));
  EXPECT_NEAR(*partingTime(a, b), 0.5, 1e-9);
  EXPECT_FALSE(partingTime(a, a)) << "an attempt does not part from itself";
  // The whole path is the checkpoint's, which takes every sample.
  int compared = 0;
  for (const StretchFigure& figure : stretchFigures({&a, &a}, {0.0, 0.0}, a.seconds)) {
    EXPECT_EQ(figure.text[0], figure.text[1]);
    for (const analytics::CheckpointValue& value : analytics::valuesFromObservables(before)) {
      if (value.name != "path-length" || figure.title != "path of the " + value.subject + " tip") continue;
      EXPECT_EQ(figure.text[0], fmt::format("{:.0f} mm", 1e3 * *value.value));
      ++compared;
    }
  }
  EXPECT_EQ(compared, 2);
}

TEST_F(Import, FoldersStandForTheRecordingsInThem) {
  const std::filesystem::path root = folder_.path().toStdString();
  std::filesystem::create_directories(root / "in");
  for (const char* name : {"in/b.h5", "in/a.h5", "in/notes.txt", "single.h5"}) std::ofstream(root / name) << "x";
  const QString in = folder_.filePath("in"), single = folder_.filePath("single.h5");
  EXPECT_EQ(recordingsIn({in, single, single}), (QStringList{in + "/a.h5", in + "/b.h5", single}));
  EXPECT_TRUE(recordingsIn({folder_.filePath("empty")}).size() == 1) << "a name is kept: the program says what it is";
}

}  // namespace
}  // namespace calot::gui
