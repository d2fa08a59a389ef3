// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/golden_update.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <memory>

#include "analytics/checkpoints/collector.h"
#include "apps/calot/environment.h"
#include "apps/calot/golden_values.h"
#include "apps/calot/source_options.h"
#include "apps/calot/stop_request.h"
#include "recorder/loop.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"
#include "recorder/formats/scene_file.h"
#include "recorder/live/worker_pool.h"
#include "recorder/recording/writer.h"
#include "sim/scene/version.h"

namespace calot::apps {

namespace {

constexpr const char* listName = "golden.json";

/// What git prints, or nothing where it fails or is not there.
std::optional<std::string> git(const std::vector<std::string>& arguments) {
  std::vector<std::string> words{"git"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  argv.reserve(words.size() + 1);
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return std::nullopt;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, "git", &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string text;
  std::array<char, 4096> buffer{};
  for (ssize_t n = 0; failed == 0 && (n = read(ends[0], buffer.data(), buffer.size())) > 0;)
    text.append(buffer.data(), static_cast<std::size_t>(n));
  close(ends[0]);
  int status = 0;
  if (failed != 0 || waitpid(child, &status, 0) != child || status != 0) return std::nullopt;
  return text;
}

GoldenEntry recordEntry(const GoldenEntry& entry, const std::filesystem::path& file) {
  recorder::LoadedScene scene = recorder::loadScene(recorder::findScene(entry.scene, assetFolders()));
  const Model::Built built = Model::build(scene.description);
  if (!built.model) throw Error(ErrorKind::damaged, fmt::format("scene {}: {}", entry.scene, built.error));
  SourceOptions who;
  who.performer = entry.performer;
  const std::unique_ptr<recorder::SampleSource> source = makeSource(who, built.model->scene(), entry.seed);
  recorder::AttemptSettings settings;
  settings.purpose = "golden";
  settings.seed = entry.seed;
  const recorder::AttemptHeader header =
      recorder::makeHeader(*built.model, std::move(scene.assets), source->provenance(), settings);
  recorder::RecordingWriter writer(file, header, {true});
  analytics::CheckpointCollector collector(header, built.model->scene());
  recorder::WorkerPool pool(1);
  recorder::Session session(*built.model, entry.seed, pool);
  session.join(writer);
  session.join(collector);
  recorder::RunSettings run;
  run.seconds = entry.seconds;
  run.stop = &stopRequested();
  recorder::runAttempt(session, *source, run);
  writer.finish();
  if (stopRequested()) throw Error(ErrorKind::failure, "golden: stopped; nothing was replaced");
  GoldenEntry made = entry;
  made.values = goldenValues(collector.values());
  return made;
}

/// Removes what was made and not taken over.
struct Temporary {
  std::vector<std::filesystem::path> files;
  ~Temporary() {
    std::error_code ignored;
    for (const std::filesystem::path& file : files) std::filesystem::remove(file, ignored);
  }
};

}  // namespace

const std::string& requiredReason(const std::string& reason) {
  if (reason.find_first_not_of(" \t\n") == std::string::npos)
    throw Error(ErrorKind::invalid, "golden: --reason: say why the recordings or their values change");
  return reason;
}

void refuseUpdate(const std::filesystem::path& folder, const GoldenList& list, const std::string& reason) {
  requiredReason(reason);
  const bool complete = std::all_of(list.recordings.begin(), list.recordings.end(),
                                    [&](const GoldenEntry& e) { return std::filesystem::exists(folder / e.file); });
  if (complete && list.simulationVersion >= simulationVersion) {
    throw Error(ErrorKind::invalid,
                fmt::format("golden: the recordings are of simulation version {} and so is this build: what changes "
                            "them raises simulationVersion (sim/scene/version.h) first",
                            list.simulationVersion));
  }
  // Of the whole work tree, but for the recordings themselves: their header names a revision.
  const std::optional<std::string> changes =
      git({"-C", folder.string(), "status", "--porcelain", "--", ":/", ":(exclude)."});
  if (!changes) {
    throw Error(ErrorKind::invalid, fmt::format("golden: {} lies in no git work tree, or git is not there: golden "
                                                "recordings belong to a revision",
                                                folder.string()));
  }
  if (!changes->empty()) {
    throw Error(ErrorKind::invalid, fmt::format("golden: the work tree has changes ({}): commit them first",
                                                changes->substr(0, changes->find('\n'))));
  }
}

void updateGolden(const std::filesystem::path& folder, const GoldenList& list, const std::string& reason,
                  const std::function<void(const GoldenEntry& before, const GoldenEntry& now)>& told) {
  GoldenList made;
  made.simulationVersion = simulationVersion;
  made.reason = reason;
  Temporary temporary;
  for (const GoldenEntry& entry : list.recordings) {
    temporary.files.push_back(folder / ("new." + entry.file));
    made.recordings.push_back(recordEntry(entry, temporary.files.back()));
    told(entry, made.recordings.back());
  }
  for (std::size_t i = 0; i < made.recordings.size(); ++i)
    std::filesystem::rename(temporary.files[i], folder / made.recordings[i].file);
  temporary.files.clear();
  recorder::writeText(folder / listName, toJson(made), true);
}

}  // namespace calot::apps
