// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/engine_server.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/engine/wire.h"
#include "recorder/formats/scene_assets.h"
#include "sim/scene/version.h"

namespace calot::recorder {

std::span<const std::byte> EngineServer::answer(std::uint32_t kind, std::span<const std::byte> payload) {
  answer_.clear();
  try {
    dispatch(kind, payload);
  } catch (const std::out_of_range& e) {
    fail(wire::FaultCode::contactSet, e.what());
  } catch (const Error& e) {
    fail(wire::FaultCode::scene, e.what());
  } catch (const std::bad_alloc&) {
    fail(wire::FaultCode::other, "out of memory");
  } catch (const std::exception& e) {
    fail(wire::FaultCode::other, e.what());
  }
  return answer_;
}

void EngineServer::fail(wire::FaultCode code, const std::string& message) {
  answer_.clear();
  appendMessage(wire::Fault{code, message}, answer_);
  ended_ = true;
}

bool EngineServer::running() {
  if (!begun_) fail(wire::FaultCode::message, "no attempt was begun: start or restore come first");
  return begun_;
}

bool EngineServer::stepped() {
  if (!running()) return false;
  if (engine_->steps() > 0) return true;
  fail(wire::FaultCode::message, "there is no keyframe before the first step");
  return false;
}

void EngineServer::dispatch(std::uint32_t kind, std::span<const std::byte> payload) {
  if (ended_) return fail(wire::FaultCode::message, "a fault was answered before: the engine has ended");
  if (kind != wire::Hello::kind && !greeted_) return fail(wire::FaultCode::message, "the first request is hello");
  if (kind > wire::Scene::kind && !model_) return fail(wire::FaultCode::message, "the second request is scene");
  switch (kind) {
    case wire::Hello::kind:
      return hello(payload);
    case wire::Scene::kind:
      return scene(payload);
    case wire::Start::kind: {
      wire::Start request;
      if (!decode(payload, request)) break;
      engine_->start(request.seed);
      begun_ = true;
      return appendMessage(wire::IsReady{0}, answer_);
    }
    case wire::Restore::kind:
      return restore(payload);
    case wire::Step::kind:
      return step(payload);
    case wire::AskKeyframe::kind:
      if (stepped()) appendMessage(wire::toWire(engine_->keyframe()), answer_);
      return;
    case wire::AskView::kind:
      if (running()) appendMessage(wire::toWire(engine_->view()), answer_);
      return;
    case wire::Explain::kind: {
      wire::Explain request;
      if (!decode(payload, request)) break;
      if (!stepped()) return;
      const auto difference = engine_->explain(request.keyframe);
      wire::IsExplained explained;
      if (difference) explained = {1, difference->field, difference->detail};
      return appendMessage(explained, answer_);
    }
    default:
      return fail(wire::FaultCode::message, "there is no request " + std::to_string(kind));
  }
  fail(wire::FaultCode::message, "request " + std::to_string(kind) + " does not have the expected number of bytes");
}

void EngineServer::hello(std::span<const std::byte> payload) {
  wire::Hello request;
  if (!decode(payload, request) || request.magic != wire::magic)
    return fail(wire::FaultCode::message, "this is not a hello to an engine");
  if (request.protocol < wire::protocol)
    return fail(wire::FaultCode::protocol, "protocol " + std::to_string(request.protocol) + " is not known");
  greeted_ = true;
  wire::IsHello answer;
  answer.simulation = simulationVersion;
  answer.result = stepResultVersion;
  answer.software = software_;
  answer.confined = static_cast<std::uint8_t>(confinement_);
  appendMessage(answer, answer_);
}

void EngineServer::scene(std::span<const std::byte> payload) {
  wire::Scene request;
  if (!decode(payload, request))
    return fail(wire::FaultCode::message, "the scene does not have the expected number of bytes");
  if (model_) return fail(wire::FaultCode::message, "an engine has one scene");
  std::vector<Asset> assets;
  for (wire::File& file : request.files) assets.push_back({std::move(file.name), std::move(file.content)});
  if (assets.empty()) return fail(wire::FaultCode::scene, "there is no scene file");
  Model::Built built = Model::build(sceneFromAssets(std::move(assets)).description);
  if (!built.model) return fail(wire::FaultCode::scene, built.error);
  model_ = std::move(built.model);
  engine_ = std::make_unique<LocalEngine>(*model_, executor_);
  wire::IsScene answer;
  answer.ticks = model_->scene().ticksPerStep;
  answer.tick = tickLength;
  answer.components = model_->layout().components;
  for (const DigestLayout::Field& f : model_->layout().fields) answer.digested.push_back({f.component, f.name});
  for (const StructureModel& s : model_->structures()) answer.structures.push_back(s.name);
  answer.columns = resultColumns(*model_);
  appendMessage(answer, answer_);
}

void EngineServer::restore(std::span<const std::byte> payload) {
  wire::Restore request;
  if (!decode(payload, request) || request.known > 1)
    return fail(wire::FaultCode::message, "restore does not have the expected number of bytes");
  std::optional<NamedSets> named;
  if (request.known == 1) named = request.named;
  if (!engine_->restore(request.keyframe, named))
    return appendMessage(wire::IsRefused{"the keyframe is not a State of the scene's model"}, answer_);
  begun_ = true;
  appendMessage(wire::IsReady{engine_->steps()}, answer_);
}

void EngineServer::step(std::span<const std::byte> payload) {
  wire::Step request;
  if (!decode(payload, request) || (request.wanted & ~wire::wantAll) != 0)
    return fail(wire::FaultCode::message, "step does not have the expected number of bytes");
  if (!running()) return;
  if (request.ticks.size() != model_->scene().ticksPerStep)
    return fail(wire::FaultCode::message, "a step has " + std::to_string(model_->scene().ticksPerStep) + " ticks");
  samples_.resize(request.ticks.size());
  logged_.resize(request.ticks.size());
  for (std::size_t i = 0; i < request.ticks.size(); ++i) {
    if (!isValid(request.ticks[i]))
      return fail(wire::FaultCode::message, "tick " + std::to_string(i) + " of the step is not a sample");
    samples_[i] = request.ticks[i].samples;
    logged_[i] = request.ticks[i].logged;
  }
  const EngineStep step = engine_->step({samples_, logged_, request.lateness});
  wire::IsStep answer;
  answer.step = step.step;
  for (const TickOutcome& tick : step.ticks)
    answer.forces.push_back({tick.hand[0].force, tick.hand[0].torque, tick.hand[1].force, tick.hand[1].torque});
  answer.components = step.digest.component;
  answer.digested = step.digest.field;
  for (const Event& event : step.result.events) answer.events.push_back(wire::toWire(event));
  appendResultRow(step.result, answer.results);
  if ((request.wanted & wire::wantKeyframe) != 0) answer.keyframe = encodePayload(wire::toWire(engine_->keyframe()));
  if ((request.wanted & wire::wantContactSets) != 0) answer.sets = encodePayload(engine_->session().contactSets());
  if ((request.wanted & wire::wantView) != 0) answer.view = encodePayload(wire::toWire(engine_->view()));
  appendMessage(answer, answer_);
}

}  // namespace calot::recorder
