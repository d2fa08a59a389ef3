// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/recorder/recording/support/synthetic.h"

#include <unistd.h>

#include <cmath>
#include <cstring>

#include "recorder/recording/layout.h"
#include "recorder/recording/writer.h"
#include "sim/instruments/instruments.h"
#include "sim/scene/version.h"

namespace calot::recorder::test {

namespace {

Vec3 randomVector(Random& r) { return {r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0)}; }

Quat randomRotation(Random& r) {
  Quat q(r.uniform(0.1, 1.0), r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0), r.uniform(-1.0, 1.0));
  q.normalize();
  return q;
}

/// One of the instruments, or none.
InstrumentKind anyInstrument(Random& r) {
  const std::size_t k = r.next() % (instruments().size() + 1);
  return k == 0 ? InstrumentKind::none : instruments()[k - 1]->kind;
}

/// Fills every field of a result.
struct RandomFields {
  Random& r;

  template <class T>
  void one(const ResultGroup&, const ResultField&, T& value) {
    fill(value);
  }
  template <class Part, class T>
  void each(const ResultGroup&, const ResultField&, std::vector<Part>& parts, T Part::*member) {
    for (Part& part : parts) fill(part.*member);
  }

 private:
  void fill(double& value) { value = r.uniform(); }
  void fill(std::uint32_t& value) { value = r.next(); }
  void fill(bool& value) { value = r.next() % 2 == 0; }
  void fill(Vec3& value) { value = randomVector(r); }
  void fill(Quat& value) { value = randomRotation(r); }
  void fill(InstrumentKind& value) { value = anyInstrument(r); }
  void fill(Cautery& value) { value = static_cast<Cautery>(r.next() % 3); }
  void fill(std::vector<double>& values) {
    for (double& value : values) fill(value);
  }
};

double onGrid(double value, double steps) { return std::floor(value * steps + 0.5) / steps; }

Vec3 onGrid(const Vec3& v, double steps) { return {onGrid(v.x(), steps), onGrid(v.y(), steps), onGrid(v.z(), steps)}; }

Quat onGrid(const Quat& q, double steps) {
  return {onGrid(q.w(), steps), onGrid(q.x(), steps), onGrid(q.y(), steps), onGrid(q.z(), steps)};
}

}  // namespace

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "calot-recording-XXXXXX").string();
  if (::mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

AttemptHeader makeHeader(std::uint32_t ticksPerStep, std::size_t organs) {
  AttemptHeader h;
  h.attempt = "0f8fad5b-d9cb-469f-a165-70867728950e";
  h.parent = "7c9e6679-7425-40de-944b-e07fc1f90ae7";
  h.forkStep = 12;
  h.startUtc = "2024-02-29T12:34:56Z";
  h.software = "calot 0.1.0";
  h.build = "test";
  h.simulationVersion = 3;
  h.stepResultVersion = stepResultVersion;
  h.participant = "P-\xC3\xA4";
  h.provenance.kind = OperatorKind::performer;
  h.provenance.profile = "skilled";
  h.provenance.profileVersion = "1";
  h.provenance.sourceFile = "";
  h.provenance.sourceSha256 = "";
  h.provenance.device = "none";
  h.provenance.calibration = "c1";
  h.station = "s";
  h.mode = Mode::assessment;
  h.purpose = "training";
  h.handedness = "left";
  h.seed = 0xFEDCBA9876543210ULL;
  h.ticksPerStep = ticksPerStep;
  h.sceneName = "touch-liver";
  h.sceneMajor = 2;
  h.sceneMinor = 7;
  Random r(5);
  for (const std::size_t size : {std::size_t{333}, std::size_t{0}, std::size_t{70001}}) {
    Asset a;
    a.name = "asset" + std::to_string(size);
    for (std::size_t i = 0; i < size; ++i) a.bytes.push_back(static_cast<std::byte>(r.next() & 0x3FU));
    h.assets.push_back(a);
  }
  h.layout.components = {"clock", "camera", "hand.left", "hand.right"};
  h.layout.fields = {{0, "clock/step"},
                     {1, "camera/position"},
                     {1, "camera/orientation"},
                     {2, "hand.left/pose"},
                     {3, "hand.right/pose"}};
  for (std::size_t o = 0; o < organs; ++o) {
    h.organs.push_back("organ" + std::to_string(o));
    h.layout.components.push_back("organ.organ" + std::to_string(o));
    const auto c = static_cast<std::uint32_t>(h.layout.components.size() - 1);
    h.layout.fields.push_back({c, h.layout.components.back() + "/position"});
    h.layout.fields.push_back({c, h.layout.components.back() + "/velocity"});
  }
  if (organs > 1) {
    h.layout.components.emplace_back("connective.bed");
    const auto c = static_cast<std::uint32_t>(h.layout.components.size() - 1);
    h.layout.fields.push_back({c, "connective.bed/alpha"});
  }
  return h;
}

AttemptHeader withStructures(AttemptHeader header, std::size_t vessels, std::size_t fat) {
  const auto add = [&header](const std::string& component) {
    const auto c = static_cast<std::uint32_t>(header.layout.components.size());
    header.layout.components.push_back(component);
    header.layout.fields.push_back({c, component + "/all"});
  };
  for (std::size_t v = 0; v < vessels; ++v) {
    header.vessels.push_back("vessel" + std::to_string(v));
    add("vessel.vessel" + std::to_string(v));
  }
  for (std::size_t f = 0; f < fat; ++f) {
    header.fat.push_back("fat" + std::to_string(f));
    add("fat.fat" + std::to_string(f));
  }
  return header;
}

Step randomStep(const AttemptHeader& header, std::uint64_t n, std::uint64_t seed) {
  Random r(seed * 1000003 + n, 7);
  Step s;
  s.samples.resize(header.ticksPerStep);
  s.ticks.resize(header.ticksPerStep);
  for (std::size_t t = 0; t < header.ticksPerStep; ++t) {
    for (std::size_t h = 0; h < handCount; ++h) {
      InstrumentSample& sample = s.samples[t].hand[h];
      sample.position = randomVector(r);
      sample.orientation = randomRotation(r);
      sample.jaw = r.uniform();
      sample.instrument = anyInstrument(r);
      sample.buttons = static_cast<std::uint8_t>(r.next());
      sample.valid = r.next() % 2 == 0;
      HandTick& tick = s.ticks[t].hand[h];
      tick.force = randomVector(r);
      tick.torque = randomVector(r);
      tick.contactSet = static_cast<std::int64_t>(n) - 1 - static_cast<std::int64_t>(n > 3 ? r.next() % 3 : 0);
    }
    s.samples[t].camera.position = randomVector(r);
    s.samples[t].camera.orientation = randomRotation(r);
    s.ticks[t].lateness = static_cast<float>(r.uniform());
  }
  s.result.step = n;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if (Kind::results.since <= header.stepResultVersion) Kind::resultsOf(s.result).resize(namesOf<Kind>(header).size());
  });
  for (HandResult& h : s.result.hand) h.structureForce.resize(header.structures().size());
  RandomFields random{r};
  StepResult::fields(s.result, header.stepResultVersion, random);
  for (std::uint32_t e = r.next() % 3; e > 0; --e) {
    Event event;
    event.step = n;
    event.kind = static_cast<EventKind>(1 + r.next() % 31);
    event.hand = r.next() % 3 == 0 ? std::uint8_t{255} : static_cast<std::uint8_t>(r.next() % 2);
    event.subject = static_cast<std::uint16_t>(r.next());
    event.position = randomVector(r);
    event.value = r.uniform();
    s.result.events.push_back(event);
  }
  const auto wide = [&r] { return (static_cast<std::uint64_t>(r.next()) << 32U) | r.next(); };
  for (std::size_t c = 0; c < header.layout.components.size(); ++c) s.digest.component.push_back(wide());
  for (std::size_t f = 0; f < header.layout.fields.size(); ++f) s.digest.field.push_back(r.next());
  s.lateness = static_cast<float>(r.uniform());
  return s;
}

Step plausibleStep(const AttemptHeader& header, std::uint64_t n) {
  Step s = randomStep(header, n, 11);  // digests stay random, as real ones are
  s.result.events.clear();
  const bool touching = (n / 100) % 3 == 0;
  for (std::size_t t = 0; t < header.ticksPerStep; ++t) {
    const double time = (static_cast<double>(n) * header.ticksPerStep + static_cast<double>(t)) * header.tickSeconds;
    for (std::size_t h = 0; h < handCount; ++h) {
      const double phase = time * (0.7 + 0.2 * static_cast<double>(h));
      // Tremor of a hand: tens of micrometres at about 10 Hz.
      const Vec3 tremor = 3e-5 * Vec3(std::sin(63.0 * time), std::cos(57.0 * time), std::sin(71.0 * time + 1.0));
      InstrumentSample& sample = s.samples[t].hand[h];
      sample.position = onGrid(
          Vec3(0.03 * std::sin(phase), 0.02 * std::cos(1.3 * phase), 0.05 * std::sin(0.6 * phase)) + tremor, 1048576.0);
      Quat q(1.0, 0.2 * std::sin(phase), 0.2 * std::cos(phase), 0.1 * std::sin(2.0 * phase));
      q.normalize();
      sample.orientation = onGrid(q, 65536.0);
      sample.jaw = onGrid(0.3 + 0.3 * std::sin(phase), 65536.0);
      sample.instrument = h == 0 ? InstrumentKind::grasper : InstrumentKind::hook;
      sample.buttons = 0;
      sample.valid = true;
      HandTick& tick = s.ticks[t].hand[h];
      tick.force = touching
                       ? onGrid(Vec3(std::sin(7.0 * time), 1.0 + std::sin(5.0 * time), std::cos(3.0 * time)), 16384.0)
                       : Vec3::Zero();
      tick.torque = 0.01 * tick.force;
      tick.contactSet = static_cast<std::int64_t>(n) - 1;
    }
    s.samples[t].camera = {Vec3(0.0, 0.0, -0.15), Quat::Identity()};
    s.ticks[t].lateness = 0.0F;
  }
  const double time = static_cast<double>(n * header.ticksPerStep) * header.tickSeconds;
  for (std::size_t h = 0; h < handCount; ++h) {
    HandResult& r = s.result.hand[h];
    r.instrument = InstrumentKind::grasper;
    r.tipReal = s.samples[0].hand[h].position;
    r.tipSimulated = r.tipReal + (touching ? Vec3(1e-3 * std::sin(time), 0.0, 0.0) : Vec3::Zero());
    r.orientation = s.samples[0].hand[h].orientation.normalized();
    r.jaw = s.samples[0].hand[h].jaw;
    r.insertion = r.tipReal.norm();
    r.contactForce = s.ticks[0].hand[h].force;
    r.contactTorque = 1e-3 * r.contactForce[0];
    r.grasping = 0;
    r.graspForce = 0.0;
    r.cautery = Cautery::off;
    r.clips = 0;
    r.touching = touching ? 1 : 0;
    for (double& f : r.structureForce) f = touching ? r.contactForce.norm() : 0.0;
  }
  for (OrganResult& o : s.result.organ) {
    o = {1.2e-3 + (touching ? 1e-7 * std::sin(time) : 0.0),
         touching ? 1e-3 * std::abs(std::sin(time)) : 0.0,
         touching ? 1e-2 * std::abs(std::cos(time)) : 0.0,
         touching ? 1e-7 * (1.0 + std::sin(99.0 * time)) : 0.0,
         touching ? 17U : 0U,
         !touching,
         0.0};
  }
  s.result.contact = {};
  if (touching) {
    s.result.contact.blocks = 2;
    s.result.contact.rows = 6;
    s.result.contact.iterations = 12;
    s.result.contact.residual = 1e-9 * (1.0 + std::cos(31.0 * time));
    s.result.contact.violation = 1e-4 * (1.0 + std::sin(29.0 * time));
  }
  s.result.misses = 0;
  if (n % 300 == 0 || n % 300 == 100) {
    Event event;
    event.step = n;
    event.kind = touching ? EventKind::contactBegin : EventKind::contactEnd;
    event.hand = 1;
    event.position = s.result.hand[1].tipReal;
    event.value = 0.5;
    s.result.events.push_back(event);
  }
  s.lateness = 0.0F;
  return s;
}

Keyframe makeKeyframe(std::uint64_t step, std::size_t bytes) {
  Keyframe k;
  k.step = step;
  k.state.resize(bytes);
  for (std::size_t i = 0; i + 8 <= bytes; i += 8) {
    const double value = 0.1 * std::sin(0.01 * static_cast<double>(i) + 0.3 * static_cast<double>(step));
    std::memcpy(&k.state[i], &value, 8);
  }
  k.haptics.resize(101 + step % 7);
  for (std::size_t i = 0; i < k.haptics.size(); ++i) k.haptics[i] = static_cast<std::byte>((i * 37 + step) & 0xFFU);
  return k;
}

void feed(Observer& observer, const AttemptHeader&, std::uint64_t count, const std::function<Step(std::uint64_t)>& make,
          std::size_t keyframeBytes) {
  for (std::uint64_t n = 0; n < count; ++n) {
    const Step s = make(n);
    const StepRecord record{
        n,
        s.samples,
        s.ticks,
        s.result,
        s.digest,
        s.lateness,
        keyframeBytes > 0 ? std::function<Keyframe()>([n, keyframeBytes] { return makeKeyframe(n, keyframeBytes); })
                          : std::function<Keyframe()>(),
        {}};
    observer.onStep(record);
  }
}

void writeRecording(const std::filesystem::path& path, const AttemptHeader& header, std::uint64_t steps,
                    std::uint64_t seed, std::size_t keyframeBytes) {
  RecordingWriter writer(path, header, {true});
  feed(
      writer, header, steps, [&](std::uint64_t n) { return randomStep(header, n, seed); }, keyframeBytes);
  writer.onEnd(Outcome::completed);
  writer.finish();
}

}  // namespace calot::recorder::test
