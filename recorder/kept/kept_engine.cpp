// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/kept/kept_engine.h"

#include <fmt/format.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/text_words.h"
#include "recorder/engine/wire.h"
#include "recorder/formats/scene_assets.h"
#include "recorder/recording/block.h"
#include "recorder/recording/layout.h"

namespace calot::recorder {

namespace {

EnginePlaces& usedPlaces() {
  static EnginePlaces places;
  return places;
}

std::vector<std::filesystem::path> splitPaths(std::string_view text) {
  std::vector<std::filesystem::path> paths;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(':'), text.size());
    if (end > 0) paths.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return paths;
}

std::filesystem::path findInPath(const char* program) {
  const char* path = std::getenv("PATH");
  for (const std::filesystem::path& folder : splitPaths(path == nullptr ? "/usr/bin:/bin" : path)) {
    if (access((folder / program).c_str(), X_OK) == 0) return folder / program;
  }
  return {};
}

/// The number between two texts that a file's name consists of.
std::optional<std::uint32_t> numberIn(std::string_view name, std::string_view before, std::string_view after) {
  if (name.size() <= before.size() + after.size() || !name.starts_with(before) || !name.ends_with(after))
    return std::nullopt;
  name = name.substr(before.size(), name.size() - before.size() - after.size());
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  if (error != std::errc() || end != name.data() + name.size() || name.front() == '0') return std::nullopt;
  return number;
}

}  // namespace

void useEngines(EnginePlaces places) { usedPlaces() = std::move(places); }
const EnginePlaces& enginePlaces() { return usedPlaces(); }

std::vector<KeptEngine> listEngines() {
  std::vector<KeptEngine> engines;
  for (const std::filesystem::path& folder : usedPlaces().folders) {
    std::error_code fault;
    std::vector<KeptEngine> here;
    for (std::filesystem::directory_iterator it(folder, fault), end; !fault && it != end; it.increment(fault)) {
      const std::string name = it->path().filename().string();
      if (const auto native = numberIn(name, "calot-engine-", ""))
        here.push_back({*native, it->path(), false, {it->path().string()}});
      const auto module = numberIn(name, "engine-", ".wasm");
      if (!module) continue;
      const bool runs = !usedPlaces().runtime.empty();
      here.push_back({*module, it->path(), true, runs ? commandOf(it->path()) : std::vector<std::string>{}});
    }
    engines.insert(engines.end(), here.begin(), here.end());
  }
  // Whatever folder: a module is for where nothing native is.
  std::ranges::stable_sort(engines, [](const KeptEngine& a, const KeptEngine& b) {
    return std::pair(a.version, a.isModule) < std::pair(b.version, b.isModule);
  });
  return engines;
}

std::vector<std::string> commandOf(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored))
    throw Error(ErrorKind::damaged, Where{file.string()}, "there is no such engine");
  // A program without a folder in its name would be looked for in PATH.
  const std::string path = std::filesystem::absolute(file).string();
  if (file.extension() != ".wasm") return {path};
  std::vector<std::string> command = usedPlaces().runtime;
  if (command.empty())
    throw Error(ErrorKind::failure, Where{file.string()}, "is a WebAssembly module, and no node is here to run it");
  command.push_back(path);
  return command;
}

std::vector<std::string> commandOfEngine(std::uint32_t version) {
  for (KeptEngine& engine : listEngines()) {
    if (engine.version == version && !engine.command.empty()) return std::move(engine.command);
  }
  return {};
}

EnginePlaces userEnginePlaces(const std::filesystem::path& programFolder,
                              const std::vector<std::filesystem::path>& assetRoots) {
  EnginePlaces places;
  if (const char* named = std::getenv("CALOT_ENGINES"); named != nullptr) {
    places.folders = splitPaths(named);
  } else {
    if (const std::filesystem::path user = userFolder("XDG_DATA_HOME", ".local/share"); !user.empty())
      places.folders.push_back(user / "calot/engines");
    places.folders.push_back(programFolder / "../lib/calot/engines");
  }
  const std::filesystem::path node = findInPath("node");
  for (const std::filesystem::path& root : assetRoots) {
    const std::filesystem::path folder = root / "engines";
    const std::filesystem::path runner = folder / "run-engine.mjs";
    std::error_code ignored;
    places.folders.push_back(folder);
    if (places.runtime.empty() && !node.empty() && std::filesystem::is_regular_file(runner, ignored))
      places.runtime = {node.string(), runner.string()};
  }
  if (access((programFolder / "calot-engine").c_str(), X_OK) == 0) places.own = programFolder / "calot-engine";
  return places;
}

namespace {

/// How long an engine may take over one answer. A step takes milliseconds, the largest scene seconds.
constexpr std::chrono::seconds enginePatience{120};

/// Golden recordings hold no results; engines send them all the same.
AttemptHeader withResults(AttemptHeader header) {
  if (isMinimal(header)) header.purpose.clear();
  return header;
}

}  // namespace

ResultReader::ResultReader(const AttemptHeader& header) : layout_(withResults(header)) {
  offset_.push_back(0);
  for (std::size_t c = layout_.results; c < layout_.events; ++c)
    offset_.push_back(offset_.back() + layout_.columns[c].rowBytes());
}

std::string ResultReader::fault(const std::vector<wire::Column>& declared) const {
  std::vector<wire::Column> ours;
  for (std::size_t c = layout_.results; c < layout_.events; ++c) {
    const Column& column = layout_.columns[c];
    if (column.width > 0)
      ours.push_back({column.path, numberType(column.element), static_cast<std::uint32_t>(column.width)});
  }
  if (ours == declared) return "";
  const auto differing = std::mismatch(ours.begin(), ours.end(), declared.begin(), declared.end());
  return differing.first == ours.end() ? fmt::format("{} is not a result of the recording", differing.second->path)
                                       : fmt::format("{} is not a result of the engine", differing.first->path);
}

std::string ResultReader::read(std::uint64_t step, std::span<const std::byte> row, StepResult& result,
                               RecordedProcedure& procedure) const {
  if (row.size() != offset_.back())
    return fmt::format("results have {} bytes instead of {}", row.size(), offset_.back());
  const auto place = [&](std::size_t column) { return row.data() + offset_[column - layout_.results]; };
  RowVisitor<decltype(place)> visit{layout_, place, step, layout_.results, false, {}};
  visitResult(result, visit);
  if (layout_.procedure) visitProcedure(procedure, visit);
  return visit.fault;
}

void EngineProcess::fail(const std::string& what) { throw Error(kind_, where_, what); }

template <class Request>
void EngineProcess::send(const Request& request) {
  request_.clear();
  appendMessage(request, request_);
  // If it has ended, receive() reports it, after its earlier answers.
  static_cast<void>(child_.channel().send(request_));
}

std::span<const std::byte> EngineProcess::receive(std::uint32_t kind, std::uint32_t* got) {
  MessageHead parsed;
  if (const std::string fault = receiveMessage(child_, parsed, payload_); !fault.empty()) fail("the engine " + fault);
  if (got != nullptr) *got = parsed.kind;
  if (parsed.kind == kind) return payload_;
  if (parsed.kind == wire::Fault::kind) {
    wire::Fault fault;
    if (!decode(payload_, fault)) fail("the engine's fault cannot be read");
    if (fault.code == wire::FaultCode::contactSet) throw std::out_of_range(fault.message);
    fail(fault.message);
  }
  if (kind == wire::IsHello::kind) fail("is not an engine");
  if (got == nullptr) fail(fmt::format("the engine answered with a message of kind {}, not {}", parsed.kind, kind));
  return payload_;
}

template <class Request>
std::span<const std::byte> EngineProcess::ask(const Request& request, std::uint32_t kind, std::uint32_t* got) {
  for (; announced_ > 0; --announced_) static_cast<void>(receive(wire::IsStep::kind));
  send(request);
  return receive(kind, got);
}

template <class Answer, class Request>
Answer EngineProcess::ask(const Request& request) {
  Answer answer;
  if (!decode(ask(request, Answer::kind), answer))
    fail(fmt::format("the engine's answer {} does not have the expected number of bytes", Answer::kind));
  return answer;
}

EngineProcess::EngineProcess(const std::vector<std::string>& command, std::uint32_t simulationVersion)
    : program_(command.back()), child_(command), where_{program_} {
  const auto answer = ask<wire::IsHello>(wire::Hello{});
  if (answer.magic != wire::magic || answer.protocol != wire::protocol) fail("is not an engine");
  if (answer.confined > static_cast<std::uint8_t>(Confinement::byHost)) fail("is not an engine");
  if (answer.simulation != simulationVersion)
    fail(fmt::format("is an engine of simulation version {}, not {}", answer.simulation, simulationVersion));
  identity_ = {answer.simulation, answer.result, answer.software, static_cast<Confinement>(answer.confined)};
}

void EngineProcess::load(const AttemptHeader& header, const Where& where) {
  where_ = where;
  kind_ = ErrorKind::damaged;
  wire::Scene request;
  for (const Asset& asset : header.assets) request.files.push_back({asset.name, asset.bytes});
  auto answer = ask<wire::IsScene>(request);
  if (answer.ticks != header.ticksPerStep)
    fail(fmt::format("its scene has {} ticks a step, the recording {}", answer.ticks, header.ticksPerStep));
  ticksPerStep_ = answer.ticks;
  layout_.components = std::move(answer.components);
  for (wire::Field& f : answer.digested) {
    if (f.component >= layout_.components.size()) fail("the engine's fields belong to no component");
    layout_.fields.push_back({f.component, std::move(f.name)});
  }
  if (layout_.components != header.layout.components || layout_.fields.size() != header.layout.fields.size())
    fail("the recorded digests have other components than the engine's State: nothing to compare");
  if (const std::string fault = nameFault(header.layout, layout_); !fault.empty()) fail(fault);
  if (identity_.stepResultVersion != header.stepResultVersion)
    fail(fmt::format("its results are of version {}, those of its engine {}", header.stepResultVersion,
                     identity_.stepResultVersion));
  if (!header.assets.empty()) down_ = downOf(header.assets.front());
  results_.emplace(header);
  if (const std::string fault = results_->fault(answer.columns); !fault.empty()) fail(fault);
}

void EngineProcess::start(std::uint64_t seed) { steps_ = ask<wire::IsReady>(wire::Start{seed}).steps; }

bool EngineProcess::restore(const Keyframe& keyframe, const std::optional<NamedSets>& named) {
  wire::Restore request;
  request.keyframe = wire::toWire(keyframe);
  if (named) {
    request.known = 1;
    request.named = *named;
  }
  std::uint32_t kind = 0;
  const std::span<const std::byte> payload = ask(request, wire::IsReady::kind, &kind);
  if (kind == wire::IsRefused::kind) return false;
  wire::IsReady answer;
  if (kind != wire::IsReady::kind || !decode(payload, answer)) fail("the engine's answer to restore cannot be read");
  steps_ = answer.steps;
  return true;
}

void EngineProcess::announce(const StepInput& input) {
  stepRequest_.lateness = input.lateness;
  stepRequest_.ticks.resize(input.samples.size());
  for (std::size_t i = 0; i < input.samples.size(); ++i) stepRequest_.ticks[i] = {input.samples[i], input.logged[i]};
  send(stepRequest_);
  ++announced_;
}

EngineStep EngineProcess::step(const StepInput& input) {
  if (announced_ == 0) announce(input);
  --announced_;
  if (!decode(receive(wire::IsStep::kind), stepAnswer_)) fail("the engine's step cannot be read");
  const wire::IsStep& answer = stepAnswer_;
  if (answer.step != steps_ || answer.forces.size() != ticksPerStep_ ||
      answer.components.size() != layout_.components.size() || answer.digested.size() != layout_.fields.size())
    fail(fmt::format("the engine's step {} is not that of the scene", steps_));
  ticks_.resize(ticksPerStep_);
  for (std::size_t i = 0; i < ticksPerStep_; ++i) {
    ticks_[i].lateness = input.logged[i].lateness;
    for (std::size_t h = 0; h < handCount; ++h)
      ticks_[i].hand[h] = {answer.forces[i][2 * h], answer.forces[i][2 * h + 1], input.logged[i].hand[h].contactSet};
  }
  digest_.component = answer.components;
  digest_.field = answer.digested;
  if (const std::string fault = results_->read(answer.step, answer.results, result_, procedure_); !fault.empty())
    fail(fault);
  result_.step = answer.step;
  result_.events.clear();
  for (const wire::Event& event : answer.events) result_.events.push_back(wire::fromWire(event));
  ++steps_;
  return {answer.step, ticks_, result_, digest_, results_->hasProcedure() ? &procedure_ : nullptr};
}

Keyframe EngineProcess::keyframe() { return ask<wire::Keyframe>(wire::AskKeyframe{}); }

SceneView EngineProcess::view() {
  SceneView view;
  if (!wire::fromWire(ask<wire::View>(wire::AskView{}), view)) fail("the engine's scene view cannot be read");
  view.down = down_;
  return view;
}

std::optional<KeyframeDifference> EngineProcess::explain(const Keyframe& recorded) {
  auto answer = ask<wire::IsExplained>(wire::Explain{wire::toWire(recorded)});
  if (answer.differs == 0) return std::nullopt;
  return KeyframeDifference{std::move(answer.field), std::move(answer.detail)};
}

std::string receiveMessage(ChildProcess& child, MessageHead& head, wire::Bytes& payload) {
  const auto deadline = std::chrono::steady_clock::now() + enginePatience;
  std::array<std::byte, messageHead> bytes{};
  using Received = Channel::Received;
  Received received = child.channel().receive(bytes, deadline);
  if (received == Received::all) {
    head = parseHead(bytes);
    if (head.length > maxPayload) return "answers with no message";
    payload.resize(static_cast<std::size_t>(head.length));
    received = child.channel().receive(payload, deadline);
  }
  if (received == Received::late) return fmt::format("gave no answer in {} s", enginePatience.count());
  if (received == Received::ended) return "ended: " + child.end().describe();
  return "";
}

namespace {

std::string listFault(const char* what, const std::vector<std::string>& recorded, const std::vector<std::string>& own) {
  if (recorded.size() != own.size())
    return fmt::format("has {} {}s, and its scene {}", recorded.size(), what, own.size());
  for (std::size_t i = 0; i < own.size(); ++i) {
    if (recorded[i] != own[i])
      return fmt::format("{} {} is called {}, and by its scene {}", what, i, shown(recorded[i]), shown(own[i]));
  }
  return "";
}

}  // namespace

std::string nameFault(const DigestLayout& recorded, const DigestLayout& engine) {
  if (std::string fault = listFault("component", recorded.components, engine.components); !fault.empty()) return fault;
  std::vector<std::string> names, own;
  for (const DigestLayout::Field& field : recorded.fields)
    names.push_back(fmt::format("{} of component {}", field.name, field.component));
  for (const DigestLayout::Field& field : engine.fields)
    own.push_back(fmt::format("{} of component {}", field.name, field.component));
  return listFault("field", names, own);
}

std::string nameFault(const AttemptHeader& header, const Model& model) {
  std::string fault;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId kind) {
    if constexpr (Kind::hasStructures) {
      if (!fault.empty() || Kind::results.since > header.stepResultVersion) return;
      std::vector<std::string> own;
      for (const StructureModel& structure : model.structures()) {
        if (structure.kind == kind) own.push_back(structure.name);
      }
      fault = listFault("structure", Kind::namesOf(header), own);
    }
  });
  return fault.empty() ? nameFault(header.layout, model.layout()) : fault;
}

}  // namespace calot::recorder
