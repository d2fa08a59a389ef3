// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/gui/dashboard/support/recorded.h"

#include <gtest/gtest.h>

#include <QApplication>
#include <QSettings>
#include <QTemporaryDir>

#include "recorder/loop.h"
#include "recorder/recording/probe.h"
#include "recorder/recording/writer.h"
#include "tests/recorder/support/small_scene.h"

namespace calot::gui::test {

std::string recordPerformer(const std::filesystem::path& file, double seconds, std::uint64_t seed,
                            const std::string& purpose) {
  using namespace recorder;
  const recorder::test::SmallScene scene = recorder::test::smallScene();
  const std::unique_ptr<SampleSource> source = recorder::test::performer(scene, "skilled", seed);
  AttemptSettings settings;
  settings.seed = seed;
  settings.purpose = purpose;
  const AttemptHeader header = makeHeader(*scene.model, scene.assets, source->provenance(), settings);
  RecordingWriter writer(file, header);
  SerialExecutor executor;
  Session session(*scene.model, seed, executor);
  session.join(writer);
  RunSettings run;
  run.seconds = seconds;
  EXPECT_EQ(runAttempt(session, *source, run).outcome, Outcome::stopped);
  writer.finish();
  return header.attempt;
}

void startApplication() {
  qputenv("QT_QPA_PLATFORM", "offscreen");
  static int count = 1;
  static char name[] = "test";
  static char* arguments[] = {name, nullptr};
  static QTemporaryDir folder;
  QSettings::setPath(QSettings::IniFormat, QSettings::UserScope, folder.path());
  // As the program does.
  static const auto* const probes = new recorder::ProbeProcesses(2, true);
  (void)probes;
  // Never destroyed: Qt's own threads outlive main() otherwise.
  static auto* const application = QApplication::instance() == nullptr ? new QApplication(count, arguments) : nullptr;
  (void)application;
}

}  // namespace calot::gui::test
