// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/force_wire.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>

namespace calot::recorder::forcewire {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian and copied as they are");

constexpr std::array<char, 8> magic{'c', 'a', 'l', 'o', 't', '-', 'f', 'd'};
constexpr std::size_t headBytes = 4;
constexpr std::size_t helloBytes = 232, welcomeBytes = 16, poseBytes = 136, wrenchBytes = 64;
constexpr std::size_t nameBytes = 64, serialBytes = 32;
constexpr double farthest = 10.0;                // m
constexpr double unitTolerance = 1e-3;           // of a quaternion's length
constexpr double mostForce = 100.0;              // N, of any device that a hand may hold
constexpr std::uint32_t longestWatchdog = 1000;  // ms

enum Kind : std::uint8_t { hello = 1, welcome = 2, pose = 3, wrench = 4, fault = 5, end = 6 };

class Packer {
 public:
  explicit Packer(Kind kind) : bytes_(headBytes) { bytes_[2] = std::byte{kind}; }
  template <class T>
  void put(T value) {
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
  }
  void put(const Vec3& v) {
    for (int k = 0; k < 3; ++k) put<double>(v[k]);
  }
  void put(const std::string& text, std::size_t room) {
    for (std::size_t i = 0; i < room; ++i) put<char>(i < text.size() && i + 1 < room ? text[i] : '\0');
  }
  void putMagic() {
    for (const char c : magic) put<char>(c);
  }
  std::vector<std::byte> done() {
    const auto length = static_cast<std::uint16_t>(bytes_.size() - headBytes);
    std::memcpy(bytes_.data(), &length, sizeof length);
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_;
};

class Unpacker {
 public:
  explicit Unpacker(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  T get() {
    T value{};
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_ = bytes_.subspan(sizeof value);
    return value;
  }
  Vec3 vector() {
    Vec3 v;
    for (int k = 0; k < 3; ++k) v[k] = get<double>();
    return v;
  }
  // Printable ASCII, so that a device's name cannot garble a terminal.
  std::string readText(std::size_t room) {
    std::string out;
    bool ended = false;
    for (std::size_t i = 0; i < room; ++i) {
      const char c = get<char>();
      ended = ended || c == '\0';
      if (!ended) out += c >= 0x20 && c < 0x7f ? c : '?';
    }
    return out;
  }
  bool hasMagic() {
    bool same = true;
    for (const char c : magic) same = get<char>() == c && same;
    return same;
  }

 private:
  std::span<const std::byte> bytes_;
};

std::vector<std::byte> bytesOf(const Hello& h) {
  Packer p(hello);
  p.putMagic();
  p.put(h.version);
  p.put(h.hands);
  p.put(std::uint8_t{0});
  p.put(h.watchdog);
  p.put(h.rate);
  for (const TankModel* m : {&h.handle.force, &h.handle.torque}) {
    p.put(m->maxEffort);
    p.put(m->damping);
    p.put(m->friction);
    p.put(m->quantum);
  }
  for (const Vec3& corner : h.workspace) p.put(corner);
  p.put(h.name, nameBytes);
  p.put(h.serial, serialBytes);
  return p.done();
}

Hello helloOf(Unpacker& u) {
  Hello h;
  h.version = u.get<std::uint16_t>();
  h.hands = u.get<std::uint8_t>();
  u.get<std::uint8_t>();
  h.watchdog = u.get<std::uint32_t>();
  h.rate = u.get<double>();
  for (TankModel* m : {&h.handle.force, &h.handle.torque}) {
    m->maxEffort = u.get<double>();
    m->damping = u.get<double>();
    m->friction = u.get<double>();
    m->quantum = u.get<double>();
    m->period = 1.0 / h.rate;
  }
  for (Vec3& corner : h.workspace) corner = u.vector();
  h.name = u.readText(nameBytes);
  h.serial = u.readText(serialBytes);
  return h;
}

std::vector<std::byte> bytesOf(const Welcome& w) {
  Packer p(welcome);
  p.putMagic();
  p.put(w.version);
  p.put(w.hands);
  p.put(std::uint8_t{0});
  p.put(std::uint32_t{0});
  return p.done();
}

Welcome welcomeOf(Unpacker& u) {
  Welcome w;
  w.version = u.get<std::uint16_t>();
  w.hands = u.get<std::uint8_t>();
  return w;
}

std::vector<std::byte> bytesOf(const Pose& s) {
  Packer p(pose);
  p.put(static_cast<std::uint8_t>(s.hand));
  p.put(static_cast<std::uint8_t>(s.valid ? 1 : 0));
  p.put(s.buttons);
  p.put(std::uint8_t{0});
  p.put(s.number);
  p.put(s.sequence);
  p.put(s.deviceTime);
  p.put(s.position);
  for (const double q : {s.orientation.w(), s.orientation.x(), s.orientation.y(), s.orientation.z()}) p.put(q);
  p.put(s.gripper);
  p.put(s.shown.force);
  p.put(s.shown.torque);
  return p.done();
}

Pose poseOf(Unpacker& u) {
  Pose s;
  s.hand = u.get<std::uint8_t>() == 0 ? Hand::left : Hand::right;
  s.valid = (u.get<std::uint8_t>() & 1U) != 0;
  s.buttons = u.get<std::uint8_t>();
  u.get<std::uint8_t>();
  s.number = u.get<std::uint32_t>();
  s.sequence = u.get<std::uint64_t>();
  s.deviceTime = u.get<std::int64_t>();
  s.position = u.vector();
  const double w = u.get<double>(), x = u.get<double>(), y = u.get<double>(), z = u.get<double>();
  s.orientation = Quat(w, x, y, z);
  s.gripper = u.get<double>();
  s.shown.force = u.vector();
  s.shown.torque = u.vector();
  return s;
}

std::vector<std::byte> bytesOf(const WrenchFrame& w) {
  Packer p(wrench);
  p.put(static_cast<std::uint8_t>(w.hand));
  p.put(std::uint8_t{0});
  p.put(std::uint16_t{0});
  p.put(w.number);
  p.put(w.deviceTime);
  p.put(w.wrench.force);
  p.put(w.wrench.torque);
  return p.done();
}

WrenchFrame wrenchOf(Unpacker& u) {
  WrenchFrame w;
  w.hand = u.get<std::uint8_t>() == 0 ? Hand::left : Hand::right;
  u.get<std::uint8_t>();
  u.get<std::uint16_t>();
  w.number = u.get<std::uint32_t>();
  w.deviceTime = u.get<std::int64_t>();
  w.wrench.force = u.vector();
  w.wrench.torque = u.vector();
  return w;
}

std::vector<std::byte> bytesOf(const Fault& f) {
  Packer p(fault);
  for (const char c : f.text.substr(0, maxText)) p.put<char>(c);
  return p.done();
}

std::vector<std::byte> bytesOf(const End&) { return Packer(end).done(); }

bool rightLength(std::uint8_t kind, std::size_t length) {
  switch (kind) {
    case hello:
      return length == helloBytes;
    case welcome:
      return length == welcomeBytes;
    case pose:
      return length == poseBytes;
    case wrench:
      return length == wrenchBytes;
    case fault:
      return length <= maxText;
    case end:
      return length == 0;
    default:
      return false;
  }
}

}  // namespace

std::vector<std::byte> encode(const Frame& frame) {
  return std::visit([](const auto& f) { return bytesOf(f); }, frame);
}

void Decoder::reset() {
  rest_.clear();
  fault_.clear();
}

bool Decoder::take(std::span<const std::byte> bytes, std::vector<Frame>& out) {
  if (!fault_.empty()) return false;
  rest_.insert(rest_.end(), bytes.begin(), bytes.end());
  std::size_t at = 0;
  while (rest_.size() - at >= headBytes) {
    std::uint16_t length = 0;
    std::memcpy(&length, rest_.data() + at, sizeof length);
    const auto kind = static_cast<std::uint8_t>(rest_[at + 2]);
    if (!rightLength(kind, length) || rest_[at + 3] != std::byte{0}) {
      fault_ = fmt::format("a frame of kind {} with {} bytes, which there is not", kind, length);
      return false;
    }
    if (rest_.size() - at - headBytes < length) break;
    const std::span<const std::byte> body(rest_.data() + at + headBytes, length);
    Unpacker u(body);
    if ((kind == hello || kind == welcome) && !u.hasMagic()) {
      fault_ = "a greeting of another protocol";
      return false;
    }
    if (kind == hello) out.emplace_back(helloOf(u));
    if (kind == welcome) out.emplace_back(welcomeOf(u));
    if (kind == pose) out.emplace_back(poseOf(u));
    if (kind == wrench) out.emplace_back(wrenchOf(u));
    if (kind == Kind::fault) out.emplace_back(Fault{u.readText(length)});
    if (kind == end) out.emplace_back(End{});
    at += headBytes + length;
  }
  rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(at));
  return true;
}

std::string faultOf(const Hello& h) {
  if (h.version != version)
    return fmt::format("it speaks version {} of the protocol, this program {}", h.version, version);
  if ((h.hands & 3U) == 0 || h.hands > 3) return "it has no hand";
  if (!(h.rate >= 100.0 && h.rate <= 10000.0)) return "its rate is not within 100 and 10000 poses a second";
  if (h.watchdog == 0 || h.watchdog > longestWatchdog) return "its watchdog is not within 1 and 1000 ms";
  for (const TankModel* m : {&h.handle.force, &h.handle.torque}) {
    for (const double value : {m->maxEffort, m->damping, m->friction, m->quantum}) {
      if (!(value >= 0.0 && value <= mostForce)) return "a limit of its motors is negative, too large or no number";
    }
  }
  for (const Vec3& corner : h.workspace) {
    if (!corner.allFinite()) return "its workspace is not finite";
  }
  return {};
}

bool isPose(const Pose& p) {
  const double length = p.orientation.norm();
  return p.position.allFinite() && p.position.norm() <= farthest && std::isfinite(length) &&
         std::abs(length - 1.0) <= unitTolerance && std::isfinite(p.gripper) && p.shown.force.allFinite() &&
         p.shown.torque.allFinite();
}

}  // namespace calot::recorder::forcewire
