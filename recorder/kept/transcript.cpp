// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/kept/transcript.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "recorder/base/child_process.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/engine/wire.h"
#include "recorder/kept/kept_engine.h"

namespace calot::recorder {

namespace {

constexpr std::size_t maxTranscript = std::size_t{1} << 28U;

/// An engine that is given whole messages.
class RawEngine {
 public:
  explicit RawEngine(const std::vector<std::string>& command) : name_(command.back()), child_(command) {}

  std::vector<std::byte> ask(const std::vector<std::byte>& request) {
    // If it has ended, receiveMessage() reports how.
    static_cast<void>(child_.channel().send(request));
    MessageHead head;
    wire::Bytes answer;
    if (const std::string fault = receiveMessage(child_, head, answer); !fault.empty())
      throw Error(ErrorKind::failure, Where{name_}, fault);
    wire::Bytes message;
    ByteWriter writer(message);
    writer.write(head.kind);
    writer.write(head.length);
    message.insert(message.end(), answer.begin(), answer.end());
    return message;
  }

 private:
  std::string name_;
  ChildProcess child_;
};

std::vector<std::byte> payloadOf(const std::vector<std::byte>& message) {
  return {message.begin() + messageHead, message.end()};
}

wire::Step stepOf(const RecordedStep& recorded, std::uint8_t wanted) {
  wire::Step step{wanted, recorded.lateness, {}};
  for (std::size_t i = 0; i < recorded.samples.size(); ++i)
    step.ticks.push_back({recorded.samples[i], recorded.ticks[i]});
  return step;
}

/// Both messages, where each is one of this type.
template <class Message>
bool decodeBoth(const std::vector<std::byte>& a, const std::vector<std::byte>& b, Message& first, Message& second) {
  return parseHead(a).kind == Message::kind && parseHead(b).kind == Message::kind && decode(payloadOf(a), first) &&
         decode(payloadOf(b), second);
}

/// Two programs that are the same engine may differ in their names, in how they are confined and in the words of a
/// fault.
bool isSame(const std::vector<std::byte>& a, const std::vector<std::byte>& b) {
  if (a == b || (parseHead(a).kind == wire::IsRefused::kind && parseHead(b).kind == wire::IsRefused::kind)) return true;
  wire::Fault fault, other;
  if (decodeBoth(a, b, fault, other)) return fault.code == other.code;
  wire::IsHello first, second;
  return decodeBoth(a, b, first, second) && first.magic == second.magic && first.protocol == second.protocol &&
         first.simulation == second.simulation && first.result == second.result;
}

}  // namespace

Transcript makeTranscript(const std::vector<std::string>& command, Recording& recording, std::uint64_t steps) {
  RawEngine engine(command);
  Transcript transcript;
  const auto ask = [&](const auto& request) {
    transcript.push_back({encode(request), {}});
    transcript.back().answer = engine.ask(transcript.back().request);
  };
  wire::Scene scene;
  for (const Asset& asset : recording.header().assets) scene.files.push_back({asset.name, asset.bytes});
  ask(wire::Hello{});
  ask(scene);
  ask(wire::Start{recording.header().seed});
  const std::uint64_t half = steps / 2;
  wire::Keyframe keyframe;
  for (std::uint64_t n = 0; n < steps; ++n) {
    ask(stepOf(recording.step(n), n == half ? wire::wantAll : std::uint8_t{0}));
    wire::IsStep answer;
    if (n != half || !decode(payloadOf(transcript.back().answer), answer)) continue;
    static_cast<void>(decode(answer.keyframe, keyframe));
  }
  ask(wire::AskKeyframe{});
  ask(wire::Explain{keyframe});
  wire::Keyframe broken = keyframe;
  if (!broken.state.empty()) broken.state.pop_back();
  ask(wire::Restore{broken, 0, {}});
  ask(wire::Restore{keyframe, 0, {}});
  for (std::uint64_t n = half + 1; n < steps; ++n) ask(stepOf(recording.step(n), 0));
  ask(wire::AskView{});
  ask(wire::Step{});  // without its ticks: a fault, and the end
  return transcript;
}

std::string compareWith(const Transcript& transcript, const std::vector<std::string>& command) {
  RawEngine engine(command);
  for (std::size_t i = 0; i < transcript.size(); ++i) {
    const std::vector<std::byte> answer = engine.ask(transcript[i].request);
    if (isSame(answer, transcript[i].answer)) continue;
    const auto differing =
        std::mismatch(answer.begin(), answer.end(), transcript[i].answer.begin(), transcript[i].answer.end());
    return fmt::format("its answer {} (to a request of kind {}) differs from byte {} on", i,
                       parseHead(transcript[i].request).kind, differing.first - answer.begin());
  }
  return "";
}

std::vector<std::byte> bytesOf(const Transcript& transcript) {
  std::vector<std::byte> bytes;
  for (const Exchange& exchange : transcript) {
    bytes.insert(bytes.end(), exchange.request.begin(), exchange.request.end());
    bytes.insert(bytes.end(), exchange.answer.begin(), exchange.answer.end());
  }
  return bytes;
}

Transcript readTranscript(const std::filesystem::path& file) {
  const std::vector<std::byte> bytes = readFileBytes(file, file.string(), maxTranscript);
  std::span<const std::byte> rest(bytes);
  const auto next = [&] {
    if (rest.size() < messageHead || parseHead(rest).length > rest.size() - messageHead)
      throw Error(ErrorKind::damaged, Where{file.string(), fmt::format("byte {}", bytes.size() - rest.size())},
                  "is not a message of an engine's transcript");
    const std::size_t size = messageHead + static_cast<std::size_t>(parseHead(rest).length);
    std::vector<std::byte> message(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(size));
    rest = rest.subspan(size);
    return message;
  };
  Transcript transcript;
  while (!rest.empty()) {
    Exchange exchange;
    exchange.request = next();
    exchange.answer = next();
    transcript.push_back(std::move(exchange));
  }
  return transcript;
}

}  // namespace calot::recorder
