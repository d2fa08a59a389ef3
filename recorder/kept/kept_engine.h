// SPDX-License-Identifier: GPL-3.0-or-later
// Kept engines on this machine: one program a simulation version (docs/explanation/engines.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recorder/base/child_process.h"
#include "recorder/base/errors.h"
#include "recorder/base/identity.h"
#include "recorder/engine/engine.h"
#include "recorder/engine/wire.h"
#include "recorder/recording/layout.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"

namespace calot::recorder {

/// Folders in which programs look for engines.
struct EnginePlaces {
  /// In order: the first that holds an engine of a version gives it. A native engine goes before a module.
  std::vector<std::filesystem::path> folders;
  /// Engine of this program's own version, for decisions in another process; empty: none.
  std::filesystem::path own;
  /// Runs a module: program and arguments that come before the module's path; empty: nothing here does.
  std::vector<std::string> runtime;
};

/// An engine that is there, whether or not it works.
struct KeptEngine {
  std::uint32_t version = 0;
  std::filesystem::path file;        ///< "calot-engine-12" or "engine-12.wasm"
  bool isModule = false;             ///< WebAssembly
  std::vector<std::string> command;  ///< that starts it; empty: a module that nothing here runs
};

/// For all engines that are opened from here on; at first there are none.
void useEngines(EnginePlaces places);
const EnginePlaces& enginePlaces();

/// Every engine in the folders, by version, in the order in which it would be taken.
std::vector<KeptEngine> listEngines();

/// Command that starts an engine's file. @throws Error (damaged) where there is no such file; (failure) where nothing
/// here runs a module
std::vector<std::string> commandOf(const std::filesystem::path& file);

/// Command that starts the engine of a version; empty if there is no such engine.
std::vector<std::string> commandOfEngine(std::uint32_t version);

/// The places of an installed or built program: CALOT_ENGINES (folders, a colon between two) where it is set, else the
/// user's data folder and `<program>/../lib/calot/engines`; then `engines` of the assets. The runtime is the first node
/// in PATH, with `run-engine.mjs` of the assets.
EnginePlaces userEnginePlaces(const std::filesystem::path& programFolder,
                              const std::vector<std::filesystem::path>& assetRoots);

/// Reads a step's results as an engine sends them, in the recording's version of StepResult.
class ResultReader {
 public:
  explicit ResultReader(const AttemptHeader& header);

  /// Describes faults of the columns that an engine declares for these recordings; empty if there are none.
  [[nodiscard]] std::string fault(const std::vector<wire::Column>& declared) const;
  /// Reads a row. @param procedure of version 3 alone
  /// @return what of it no engine makes, or nothing @pre fault() had nothing to say
  [[nodiscard]] std::string read(std::uint64_t step, std::span<const std::byte> row, StepResult& result,
                                 RecordedProcedure& procedure) const;
  /// The scene has a procedure that this version of StepResult judged.
  [[nodiscard]] bool hasProcedure() const { return layout_.procedure; }

 private:
  Layout layout_;
  std::vector<std::size_t> offset_;  ///< in a row, of each column of results, and its end
};

/// An engine that is another program (schemas/engine.md). Whatever becomes of it is an error of the recording that it
/// was to decide, and of nothing else: it ends, it answers nonsense, it does not answer in time.
class EngineProcess final : public Engine {
 public:
  /// Starts the program and greets it. @param command program and arguments
  /// @throws Error (undecided) where it cannot be started, is no engine, or one of another version
  EngineProcess(const std::vector<std::string>& command, std::uint32_t simulationVersion);

  /// Gives it the scene of a recording. @param where of the recording, for errors @throws Error (damaged)
  void load(const AttemptHeader& header, const Where& where);

  [[nodiscard]] const EngineIdentity& identity() const { return identity_; }

  [[nodiscard]] const DigestLayout& layout() const override { return layout_; }
  void start(std::uint64_t seed) override;
  [[nodiscard]] bool restore(const Keyframe& keyframe, const std::optional<NamedSets>& named) override;
  [[nodiscard]] std::uint64_t steps() const override { return steps_; }
  EngineStep step(const StepInput& input) override;
  /// A program that waits between its steps is a tenth slower: it wakes on another core.
  [[nodiscard]] std::size_t takesAhead() const override { return 4; }
  void announce(const StepInput& input) override;
  [[nodiscard]] Keyframe keyframe() override;
  [[nodiscard]] SceneView view() override;
  [[nodiscard]] std::optional<KeyframeDifference> explain(const Keyframe& recorded) override;

 private:
  template <class Request>
  void send(const Request& request);
  /// The payload of the next answer, of this kind. @param got takes the kind, which then may be another
  std::span<const std::byte> receive(std::uint32_t kind, std::uint32_t* got = nullptr);
  template <class Request>
  std::span<const std::byte> ask(const Request& request, std::uint32_t kind, std::uint32_t* got = nullptr);
  template <class Answer, class Request>
  Answer ask(const Request& request);
  [[noreturn]] void fail(const std::string& what);

  std::string program_;
  ChildProcess child_;
  Where where_;
  ErrorKind kind_ = ErrorKind::undecided;  ///< of what goes wrong: until it has a scene, the program is at fault
  EngineIdentity identity_;
  DigestLayout layout_;
  std::optional<ResultReader> results_;
  Vec3 down_ = SceneView().down;  ///< no engine reports it
  std::uint64_t steps_ = 0;
  std::size_t ticksPerStep_ = 0;
  std::size_t announced_ = 0;  ///< steps whose answers were not taken yet
  wire::Bytes request_, payload_;
  wire::Step stepRequest_;
  wire::IsStep stepAnswer_;
  std::vector<TickOutcome> ticks_;
  StepResult result_;
  StateDigest digest_;
  RecordedProcedure procedure_;
};

/// Takes an engine's next message. @returns why there is none: "ended: exit code 7"; empty where there is one
std::string receiveMessage(ChildProcess& child, MessageHead& head, wire::Bytes& payload);

/// Re-simulation computes values, not what they are called: whether a recording's structures, components and fields
/// have the names that its own scene gives them. @return one phrase of the first that has another; or empty
/// @pre the recording is of this program's simulation version
std::string nameFault(const AttemptHeader& header, const Model& model);

/// The same of digests alone, for an engine that is another program.
std::string nameFault(const DigestLayout& recorded, const DigestLayout& engine);

}  // namespace calot::recorder
