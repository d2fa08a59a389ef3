// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/force_wire.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

namespace calot::recorder::forcewire {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are little-endian and copied as they are");

constexpr std::string_view magic = "calot-fd";
constexpr std::size_t headBytes = 4;
constexpr std::size_t nameBytes = 64, serialBytes = 32;
constexpr double farthest = 10.0;                // m
constexpr double unitTolerance = 1e-3;           // of a quaternion's length
constexpr double mostForce = 100.0;              // N, of any device that a hand may hold
constexpr std::uint32_t longestWatchdog = 1000;  // ms

/// Frames by their kind on the wire, from 1, and the length of their bodies; of a fault the greatest.
const std::array<Frame, 6> kinds{Hello(), Welcome(), Pose(), WrenchFrame(), Fault(), End()};
constexpr std::array<std::size_t, kinds.size()> bodyBytes{232, 16, 136, 64, maxText, 0};
constexpr std::size_t faultKind = 5;

class Writer {
 public:
  void number(const auto& value) {
    const auto* from = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), from, from + sizeof value);
  }
  void text(std::string_view text, std::size_t room) {
    for (std::size_t i = 0; i < room; ++i) number(i < text.size() && i + 1 < room ? text[i] : '\0');
  }
  void rest(const std::string& text) {
    for (const char c : text.substr(0, maxText)) number(c);
  }
  void magicWord() {
    for (const char c : magic) number(c);
  }
  void gap(std::size_t bytes) { bytes_.resize(bytes_.size() + bytes); }

  /// @param kind from 1
  std::vector<std::byte> frame(std::size_t kind) {
    const auto length = static_cast<std::uint16_t>(bytes_.size() - headBytes);
    std::memcpy(bytes_.data(), &length, sizeof length);
    bytes_[2] = static_cast<std::byte>(kind);
    return std::move(bytes_);
  }

 private:
  std::vector<std::byte> bytes_{headBytes};
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  void number(auto& value) {
    std::memcpy(&value, bytes_.data(), sizeof value);
    gap(sizeof value);
  }
  /// Printable ASCII, so that a device's name cannot garble a terminal.
  void text(std::string& out, std::size_t room) {
    out.clear();
    for (const std::byte b : bytes_.first(room)) {
      const auto c = static_cast<char>(b);
      if (c == '\0') break;
      out += c >= 0x20 && c < 0x7f ? c : '?';
    }
    gap(room);
  }
  void rest(std::string& out) { text(out, bytes_.size()); }
  void magicWord() {
    sound_ = std::memcmp(bytes_.data(), magic.data(), magic.size()) == 0;
    gap(magic.size());
  }
  void gap(std::size_t bytes) { bytes_ = bytes_.subspan(bytes); }
  /// Did the magic word fit?
  [[nodiscard]] bool sound() const { return sound_; }

 private:
  std::span<const std::byte> bytes_;
  bool sound_ = true;
};

// Fields in their order on the wire, for both directions.

void vector(auto& w, Vec3& v) {
  for (int k = 0; k < 3; ++k) w.number(v[k]);
}

void handOf(auto& w, Hand& hand) {
  auto number = static_cast<std::uint8_t>(hand);
  w.number(number);
  hand = number == 0 ? Hand::left : Hand::right;
}

void fields(auto& w, Hello& h) {
  w.magicWord();
  w.number(h.version);
  w.number(h.hands);
  w.gap(1);
  w.number(h.watchdog);
  w.number(h.rate);
  for (TankModel* m : {&h.handle.force, &h.handle.torque}) {
    for (double* value : {&m->maxEffort, &m->damping, &m->friction, &m->quantum}) w.number(*value);
    m->period = 1.0 / h.rate;
  }
  for (Vec3& corner : h.workspace) vector(w, corner);
  w.text(h.name, nameBytes);
  w.text(h.serial, serialBytes);
}

void fields(auto& w, Welcome& welcome) {
  w.magicWord();
  w.number(welcome.version);
  w.number(welcome.hands);
  w.gap(5);
}

void fields(auto& w, Pose& p) {
  handOf(w, p.hand);
  std::uint8_t flags = p.valid ? 1 : 0;
  w.number(flags);
  p.valid = (flags & 1U) != 0;
  w.number(p.buttons);
  w.gap(1);
  w.number(p.number);
  w.number(p.sequence);
  w.number(p.deviceTime);
  vector(w, p.position);
  for (double* part : {&p.orientation.w(), &p.orientation.x(), &p.orientation.y(), &p.orientation.z()}) w.number(*part);
  w.number(p.gripper);
  vector(w, p.shown.force);
  vector(w, p.shown.torque);
}

void fields(auto& w, WrenchFrame& f) {
  handOf(w, f.hand);
  w.gap(3);
  w.number(f.number);
  w.number(f.deviceTime);
  vector(w, f.wrench.force);
  vector(w, f.wrench.torque);
}

void fields(auto& w, Fault& f) { w.rest(f.text); }

void fields(auto&, End&) {}

bool rightLength(std::size_t kind, std::size_t length) {
  if (kind == faultKind) return length <= maxText;
  return kind >= 1 && kind <= kinds.size() && length == bodyBytes[kind - 1];
}

}  // namespace

std::vector<std::byte> encode(Frame frame) {
  Writer writer;
  std::visit([&](auto& f) { fields(writer, f); }, frame);
  return writer.frame(frame.index() + 1);
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
    const auto kind = std::to_integer<std::size_t>(rest_[at + 2]);
    if (!rightLength(kind, length) || rest_[at + 3] != std::byte{0}) {
      fault_ = fmt::format("a frame of kind {} with {} bytes, which there is not", kind, length);
      return false;
    }
    if (rest_.size() - at - headBytes < length) break;
    Reader reader(std::span<const std::byte>(rest_).subspan(at + headBytes, length));
    Frame frame = kinds[kind - 1];
    std::visit([&](auto& f) { fields(reader, f); }, frame);
    if (!reader.sound()) {
      fault_ = "a greeting of another protocol";
      return false;
    }
    out.push_back(std::move(frame));
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
