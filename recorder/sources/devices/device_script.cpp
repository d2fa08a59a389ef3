// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/device_script.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/record_json.h"
#include "recorder/sources/devices/force/force_output.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::recorder {
namespace {

constexpr std::size_t maxBytes = std::size_t{1} << 28U;
constexpr std::size_t maxSamples = 1000000;
constexpr double longest = 36000.0;     // s
constexpr double farthest = 10.0;       // m
constexpr double unitTolerance = 1e-3;  // of a quaternion's norm
constexpr std::size_t sampleNumbers = 12;
constexpr double nanosecondsPerSecond = 1e9;

/// An unplugging, whose end is its length, or a phase, as files state them.
struct Interval {
  std::string name;
  double from = 0.0, to = 0.0;  ///< s

  static std::vector<Field> unplugFields() {
    using S = Interval;
    return {object("unplug", "Interval without the device"),
            {"at", at<S, &S::from>, "s", within(0, longest), "Beginning"},
            {"for", at<S, &S::to>, "s", within(0, longest), "Length"}};
  }
  static std::vector<Field> phaseFields() {
    using S = Interval;
    return {object("phase", "Labelled interval"),
            {"name", at<S, &S::name>, TextRule{64}, "Label"},
            {"from", at<S, &S::from>, "s", within(0, longest), "Beginning"},
            {"to", at<S, &S::to>, "s", within(0, longest), "End"}};
  }
};

std::vector<Field> scriptFields() {
  using S = DeviceScript;
  return {object("", "Samples of a scripted device"),
          fileFormat("calot-device-script"),
          fileFormatVersion(),
          {"name", at<S, &S::name>, TextRule{64}, "Device that made it, or that it stands for"},
          optional("rate", at<S, &S::rate>, "1/s", within(0, 10000), "Nominal rate"),
          optional("largestForce", at<S, &S::maxForce>, "N", within(0, 100), "Force of its motors"),
          {"samples", unchecked, "Samples"},
          optional("unplug", unchecked, "Intervals without the device"),
          optional("phases", unchecked, "Labelled intervals")};
}

std::int64_t nanoseconds(double seconds) {
  return static_cast<std::int64_t>(std::floor(seconds * nanosecondsPerSecond + 0.5));
}

double seconds(std::int64_t time) { return static_cast<double>(time) / nanosecondsPerSecond; }

DeviceSample sampleAt(const JsonPlace& place, std::array<std::uint64_t, handCount>& sequence) {
  const std::vector<JsonPlace> item = place.list(sampleNumbers, sampleNumbers);
  const auto number = [&](std::size_t i, double lower, double upper) { return item[i].number(within(lower, upper)); };
  const auto integer = [&](std::size_t i, double upper) { return item[i].integer(within(0, upper)); };
  DeviceSample s;
  s.hostTime = s.deviceTime = nanoseconds(number(0, 0, longest));
  s.hand = static_cast<Hand>(integer(1, handCount - 1));
  s.sequence = sequence[static_cast<std::size_t>(s.hand)]++;
  for (int i = 0; i < 3; ++i) s.position[i] = number(2 + static_cast<std::size_t>(i), -farthest, farthest);
  Quat q(number(5, -2, 2), number(6, -2, 2), number(7, -2, 2), number(8, -2, 2));
  if (!(std::abs(q.norm() - 1.0) <= unitTolerance)) {
    place.fail(fmt::format("numbers 6 to 9 are not a unit quaternion (norm {:.4g})", q.norm()));
  }
  s.orientation = q.normalized();
  s.gripper = number(9, -4, 4);
  s.buttons = static_cast<std::uint8_t>(integer(10, 255));
  s.valid = integer(11, 1) == 1;
  return s;
}

DeviceScript parseJson(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json document = parseStrictJson(bytes, file);
  const JsonPlace root(document, file);
  DeviceScript script;
  readRecord(root, recordOf<DeviceScript, scriptFields>(), &script);
  std::array<std::uint64_t, handCount> sequence{};
  for (const JsonPlace& place : root.at("samples").list(1, maxSamples)) {
    script.samples.push_back(sampleAt(place, sequence));
    if (script.samples.size() > 1 &&
        script.samples.back().hostTime < script.samples[script.samples.size() - 2].hostTime)
      place.fail("the time lies before that of the sample before it");
  }
  if (root.has("unplug")) {
    for (const JsonPlace& place : root.at("unplug").list(0, 1000)) {
      Interval gone;
      readRecord(place, recordOf<Interval, Interval::unplugFields>(), &gone);
      script.unpluggings.push_back({nanoseconds(gone.from), nanoseconds(gone.to)});
    }
  }
  if (root.has("phases")) {
    for (const JsonPlace& place : root.at("phases").list(0, 100)) {
      Interval phase;
      readRecord(place, recordOf<Interval, Interval::phaseFields>(), &phase);
      if (!(phase.from < phase.to)) place.fail("\"to\" is not after \"from\"");
      script.phases.push_back({phase.name, nanoseconds(phase.from), nanoseconds(phase.to)});
    }
  }
  return script;
}

DeviceScript fromMotion(const KinematicsMotion& motion) {
  DeviceScript script;
  script.name = "motion";
  script.motionFile = true;
  script.rate = kinematicsRowsPerSecond;
  for (std::size_t i = 0; i < motion.rows.size(); ++i) {
    for (std::size_t h = 0; h < handCount; ++h) {
      DeviceSample s;
      s.hostTime = s.deviceTime = static_cast<std::int64_t>(i) * 1'000'000'000 / kinematicsRowsPerSecond;
      s.sequence = i;
      s.hand = static_cast<Hand>(h);
      s.position = motion.rows[i][h].position;
      s.orientation = motion.rows[i][h].orientation;
      s.gripper = std::max(0.0, motion.rows[i][h].gripper);  // below zero is a closed gripper that presses
      script.samples.push_back(s);
    }
  }
  return script;
}

}  // namespace

DeviceScript readDeviceScript(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseDeviceScript(readFileBytes(file, name, maxBytes), name);
}

DeviceScript parseDeviceScript(std::span<const std::byte> bytes, const std::string& file) {
  const auto first = std::find_if(bytes.begin(), bytes.end(), [](std::byte b) {
    const auto c = static_cast<char>(b);
    return c != ' ' && c != '\n' && c != '\r' && c != '\t';
  });
  if (first == bytes.end()) throw Error(ErrorKind::damaged, Where{file}, "the file is empty");
  DeviceScript script = *first == std::byte{'{'} ? parseJson(bytes, file) : fromMotion(parseKinematics(bytes, file));
  script.file = file;
  script.sha256 = sha256Hex(bytes);
  return script;
}

std::string deviceScriptText(const DeviceScript& script) {
  nlohmann::ordered_json out{{"format", "calot-device-script"}, {"formatVersion", 1}, {"name", script.name}};
  out["rate"] = script.rate;
  out["largestForce"] = script.maxForce;
  for (const DeviceScript::Phase& p : script.phases) {
    out["phases"].push_back({{"name", p.name}, {"from", seconds(p.from)}, {"to", seconds(p.to)}});
  }
  for (const DeviceScript::Unplugging& u : script.unpluggings) {
    out["unplug"].push_back({{"at", seconds(u.at)}, {"for", seconds(u.length)}});
  }
  std::string text = out.dump(2);
  text.resize(text.rfind('\n'));  // without the closing brace: the samples follow, one to a line
  text += ",\n  \"samples\": [";
  bool first = true;
  for (const DeviceSample& s : script.samples) {
    text += fmt::format("{}\n    [{:.9f}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}]", first ? "" : ",",
                        seconds(s.hostTime), static_cast<int>(s.hand), s.position.x(), s.position.y(), s.position.z(),
                        s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z(), s.gripper,
                        s.buttons, s.valid ? 1 : 0);
    first = false;
  }
  return text + "\n  ]\n}\n";
}

void WrenchGate::command(const Wrench& wrench, std::int64_t now) {
  wrench_ = {limited(wrench.force, force_), limited(wrench.torque, torque_)};
  commanded_ = now;
  any_ = true;
}

Wrench WrenchGate::output(std::int64_t now) const {
  if (!any_ || now - commanded_ >= watchdog) return {};
  return wrench_;
}

ScriptedDevice::ScriptedDevice(DeviceScript script, DeviceClock clock)
    : Device(std::move(clock)),
      script_(std::move(script)),
      gate_{WrenchGate(script_.maxForce, 0.0), WrenchGate(script_.maxForce, 0.0)},
      origin_(clock_()) {
  std::sort(script_.unpluggings.begin(), script_.unpluggings.end(),
            [](const auto& a, const auto& b) { return b.at > a.at; });
  info_.name = scriptedKind.name;
  info_.identity = "scripted:" + script_.name;
  info_.detail = "plays " + script_.file;
  info_.operatorKind = script_.motionFile ? OperatorKind::kinematics : OperatorKind::performer;
  info_.sourceFile = script_.file;
  info_.sourceSha256 = script_.sha256;
  std::array<bool, handCount> hand{};
  for (const DeviceSample& s : script_.samples) hand[static_cast<std::size_t>(s.hand)] = true;
  info_.capabilities.hands = static_cast<int>(hand[0]) + static_cast<int>(hand[1]);
  info_.capabilities.sensesGripper = true;
  info_.capabilities.actuated = script_.maxForce > 0.0 ? 3 : 0;
  info_.capabilities.maxForce = script_.maxForce;
  info_.capabilities.rate = script_.rate;
  info_.capabilities.realTime = false;
}

void ScriptedDevice::poll(std::chrono::nanoseconds, DeviceInput& out) {
  if (!open_) return;
  const std::int64_t now = clock_();
  if (!greeted_) {
    greeted_ = connected_ = true;
    tell(DeviceEvent::Kind::connected, info_.identity + ": there", out);
  }
  for (;;) {
    const bool more = unplugging_ < script_.unpluggings.size();
    const std::int64_t gone = more ? origin_ + script_.unpluggings[unplugging_].at : now + 1;
    const std::int64_t back = more ? gone + script_.unpluggings[unplugging_].length : gone;
    const std::int64_t until = std::min(now, gone - 1);
    for (; next_ < script_.samples.size() && origin_ + script_.samples[next_].hostTime <= until; ++next_) {
      out.samples.push_back(script_.samples[next_]);
      out.samples.back().hostTime += origin_;
    }
    if (now < gone) return;
    if (connected_) {
      connected_ = false;
      out.events.push_back({DeviceEvent::Kind::disconnected, gone, info_.identity + ": unplugged"});
    }
    if (now < back) return;
    origin_ += script_.unpluggings[unplugging_].length;
    ++unplugging_;
    connected_ = true;
    out.events.push_back({DeviceEvent::Kind::connected, back, info_.identity + ": there again"});
  }
}

void ScriptedDevice::setWrench(Hand hand, const Wrench& wrench) {
  gate_[static_cast<std::size_t>(hand)].command(wrench, clock_());
}

Wrench ScriptedDevice::shown(Hand hand) const {
  if (!connected_) return {};
  return gate_[static_cast<std::size_t>(hand)].output(clock_());
}

constinit const DeviceKind scriptedKind{
    .name = "scripted",
    .usage = "scripted:FILE",
    .help = "plays a script or a kinematics file",
    .row = {"scripted:FILE", "plays a script or a kinematics file", "2", "6, jaw, buttons", "the file's"},
    .open =
        [](const DeviceRequest& request) {
          if (request.argument.empty()) request.refuse("a file is missing: scripted:FILE");
          auto ticks = std::make_shared<TickClock>();
          return OpenedDevice{
              std::make_unique<ScriptedDevice>(readDeviceScript(request.argument), [ticks] { return ticks->now; }),
              ticks};
        },
};

}  // namespace calot::recorder
