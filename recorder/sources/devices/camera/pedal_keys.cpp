// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/pedal_keys.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/input.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

constexpr double jawSpeedOfKeys = 1.8;  // rad/s, as by the trainer's keys

struct KeySet {
  int open, close, lock, cut, cutToo, coagulate, coagulateToo, fire, more, less;
};
constexpr std::array<KeySet, handCount> keySets{
    KeySet{KEY_Q, KEY_A, KEY_LEFTALT, KEY_Z, KEY_Z, KEY_X, KEY_X, KEY_1, KEY_2, KEY_3},
    KeySet{KEY_P, KEY_L, KEY_RIGHTALT, KEY_COMMA, KEY_F1, KEY_DOT, KEY_F2, KEY_0, KEY_9, KEY_8}};

}  // namespace

PedalKeys::PedalKeys(const std::string& file) : file_(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {
  if (file_ < 0) {
    throw Error(
        ErrorKind::failure, Where{file},
        fmt::format("the keyboard cannot be read: {} (members of the group \"input\" may)", std::strerror(errno)));
  }
}

PedalKeys::~PedalKeys() {
  if (file_ >= 0) ::close(file_);
}

bool PedalKeys::read() {
  for (;;) {
    input_event event{};
    const ssize_t got = file_ < 0 ? -1 : ::read(file_, &event, sizeof event);
    if (got == static_cast<ssize_t>(sizeof event)) {
      // 0 up, 1 down, 2 repeats
      if (event.type == EV_KEY && event.code < down_.size()) down_[event.code] = event.value != 0;
      continue;
    }
    if (file_ >= 0 && got < 0 && (errno == EAGAIN || errno == EINTR)) return true;
    // Unplugged, or at its end: a pedal that nobody can let go would cut for ever.
    down_.fill(false);
    if (file_ >= 0) ::close(file_);
    file_ = -1;
    return false;
  }
}

PedalKeys::Hold PedalKeys::hold(Hand hand) const {
  const KeySet& key = keySets[static_cast<std::size_t>(hand)];
  const auto is = [&](int code) { return down_[static_cast<std::size_t>(code)]; };
  Hold out;
  const auto press = [&](bool held, std::uint8_t bit) {
    if (held) out.buttons = static_cast<std::uint8_t>(out.buttons | bit);
  };
  press(is(key.cut) || is(key.cutToo), button::cutPedal);
  press(is(key.coagulate) || is(key.coagulateToo), button::coagulatePedal);
  press(is(key.fire), button::fire);
  press(is(key.lock), button::lock);
  press(is(key.more), button::retractMore);
  press(is(key.less), button::retractLess);
  out.jawRate = (is(key.open) ? jawSpeedOfKeys : 0.0) - (is(key.close) ? jawSpeedOfKeys : 0.0);
  return out;
}

}  // namespace calot::recorder
