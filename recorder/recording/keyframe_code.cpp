// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/keyframe_code.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace calot::recorder {

namespace {

constexpr std::size_t wordBytes = 8;
constexpr std::size_t headWords = 2;         // base, parts
constexpr std::size_t descriptionWords = 4;  // length, place, like, form

std::uint64_t wordsOf(std::uint64_t bytes) { return bytes / wordBytes + (bytes % wordBytes != 0 ? 1 : 0); }

/// Bytes from `at` on as a word, continued by zeros.
std::uint64_t wordAt(std::span<const std::byte> bytes, std::size_t at) {
  std::uint64_t word = 0;
  if (at < bytes.size()) std::memcpy(&word, bytes.data() + at, std::min(wordBytes, bytes.size() - at));
  return word;
}

std::uint64_t zigzag(std::uint64_t difference) { return (difference << 1U) ^ (0U - (difference >> 63U)); }
std::uint64_t unzigzag(std::uint64_t code) { return (code >> 1U) ^ (0U - (code & 1U)); }

/// One part, and the bytes of the base that it is compared with.
struct Part {
  std::uint64_t length = 0, place = 0, like = 0;
  PartForm form = PartForm::plain;

  /// Can another one that follows be written as one with this? Both must fill whole words, and so must what they are
  /// compared with.
  [[nodiscard]] bool continuedBy(const Part& next) const {
    if (length % wordBytes != 0 || form != PartForm::plain || next.form != PartForm::plain) return false;
    if (like == 0 && next.like == 0) return true;
    return like == length && next.like == next.length && place + like == next.place;
  }
};

/// From how many words on a run that did not change is a part of its own.
constexpr std::size_t leastRun = 64;

/// Divides a plain part into what changed and long runs of whole words that did not.
void divide(Part part, std::span<const std::byte> own, std::span<const std::byte> other, std::vector<Part>& out) {
  const auto sameAt = [&](std::size_t w) {
    return (w + 1) * wordBytes <= other.size() && wordAt(own, w * wordBytes) == wordAt(other, w * wordBytes);
  };
  const auto cut = [&](std::size_t words, PartForm form) {
    Part front = part;
    front.form = form;
    front.length = words * wordBytes;
    front.like = std::min(front.length, part.like);
    out.push_back(front);
    part.length -= front.length;
    part.like -= front.like;
    part.place += front.like;
  };
  const std::size_t words = other.size() / wordBytes;
  std::size_t begin = 0;
  for (std::size_t w = 0; w < words; ++w) {
    std::size_t run = 0;
    while (sameAt(w + run)) ++run;
    if (run >= leastRun) {
      if (w > begin) cut(w - begin, PartForm::plain);
      cut(run, PartForm::unchanged);
      begin = w + run;
    }
    w += run;
  }
  if (part.length > 0) out.push_back(part);
}

/// The words of a part of some form that follow from others of it. Its first word is the number of elements.
class Derived {
 public:
  Derived(PartForm form, std::size_t bytes) : form_(form), elements_(bytes / wordBytes) {
    if (bytes % wordBytes != 0 || elements_ == 0) form_ = PartForm::plain;
    if (form_ == PartForm::plain) return;
    --elements_;
    if (form_ == PartForm::symmetricMatrix) {
      while (rows_ * rows_ < elements_) ++rows_;
      if (rows_ * rows_ != elements_) form_ = PartForm::plain;
    } else if (elements_ % (form_ == PartForm::quaternions ? 4 : 4 * lanes) != 0) {
      form_ = PartForm::plain;
    }
  }

  /// Does word w follow from others? None of those does.
  [[nodiscard]] bool has(std::size_t w) const {
    if (form_ == PartForm::plain || w == 0) return false;
    const std::size_t i = w - 1;
    switch (form_) {
      case PartForm::quaternions:
        return i % 4 == 3;
      case PartForm::quaternionsByLane:
        return i / lanes % 4 == 0;
      case PartForm::symmetricMatrix:
        return i % rows_ < i / rows_;
      case PartForm::plain:
      case PartForm::unchanged:
        break;
    }
    return false;
  }

  /// Prediction of word w, but for its last bits. @pre has(w); the words that it follows from are there
  [[nodiscard]] std::uint64_t of(std::span<const std::byte> part, std::size_t w) const {
    switch (form_) {
      case PartForm::quaternions:
        return fourth(part, w - 3, 1);
      case PartForm::quaternionsByLane:
        return fourth(part, w + lanes, lanes);
      case PartForm::symmetricMatrix:
        return wordAt(part, (1 + (w - 1) % rows_ * rows_ + (w - 1) / rows_) * wordBytes);
      case PartForm::plain:
      case PartForm::unchanged:
        break;
    }
    return 0;
  }

 private:
  static constexpr std::size_t lanes = 8;

  /// The w > 0 of a unit quaternion from its other parts.
  static std::uint64_t fourth(std::span<const std::byte> part, std::size_t first, std::size_t apart) {
    const auto at = [&](std::size_t n) { return std::bit_cast<double>(wordAt(part, (first + n * apart) * wordBytes)); };
    const double x = at(0);
    const double y = at(1);
    const double z = at(2);
    const double rest = 1.0 - ((x * x + y * y) + z * z);
    return rest > 0.0 ? std::bit_cast<std::uint64_t>(std::sqrt(rest)) : 0;
  }

  PartForm form_;
  std::size_t elements_;
  std::size_t rows_ = 0;
};

}  // namespace

std::optional<std::uint64_t> writtenBase(std::uint64_t index) {
  if (index == 0) return std::nullopt;
  std::uint64_t digit = 1;
  while (index % (4 * digit) == 0) digit *= 4;
  return index - digit;
}

std::vector<std::uint64_t> KeyframeCoder::code(const Keyframe& keyframe) {
  Known now;
  now.bytes.reserve(keyframe.state.size() + keyframe.haptics.size());
  now.bytes.insert(now.bytes.end(), keyframe.state.begin(), keyframe.state.end());
  now.bytes.insert(now.bytes.end(), keyframe.haptics.begin(), keyframe.haptics.end());
  now.parts = keyframe.parts;
  if (now.parts.empty()) {
    now.parts = {{static_cast<std::uint32_t>(keyframe.state.size())},
                 {static_cast<std::uint32_t>(keyframe.haptics.size())}};
  }

  const std::optional<std::uint64_t> baseIndex = writtenBase(next_);
  const Known* base = baseIndex ? &known_.at(*baseIndex) : nullptr;
  std::vector<Part> parts;
  std::uint64_t place = 0;
  for (std::size_t i = 0; i < now.parts.size(); ++i) {
    Part part{now.parts[i].bytes, 0, 0, now.parts[i].form};
    if (base != nullptr && i < base->parts.size()) {
      part.like = std::min<std::uint64_t>(part.length, base->parts[i].bytes);
      part.place = place;
      place += base->parts[i].bytes;
    }
    if (!parts.empty() && parts.back().continuedBy(part)) {
      parts.back().length += part.length;
      parts.back().like += part.like;
    } else {
      parts.push_back(part);
    }
  }

  const std::span<const std::byte> bytes = now.bytes;
  const std::span<const std::byte> others = base == nullptr ? std::span<const std::byte>{} : std::span(base->bytes);
  std::vector<Part> divided;
  std::size_t at = 0;
  for (const Part& part : parts) {
    const auto own = bytes.subspan(at, static_cast<std::size_t>(part.length));
    const auto other = others.subspan(static_cast<std::size_t>(part.place), static_cast<std::size_t>(part.like));
    at += own.size();
    if (part.form == PartForm::plain) {
      divide(part, own, other, divided);
    } else {
      divided.push_back(part);
    }
  }
  std::vector<std::uint64_t> words{baseIndex ? *baseIndex + 1 : 0, divided.size()};
  for (const Part& part : divided)
    words.insert(words.end(), {part.length, part.place, part.like, static_cast<std::uint64_t>(part.form)});
  at = 0;
  for (const Part& part : divided) {
    const auto own = bytes.subspan(at, static_cast<std::size_t>(part.length));
    at += own.size();
    if (part.form == PartForm::unchanged) continue;
    const auto other = others.subspan(static_cast<std::size_t>(part.place), static_cast<std::size_t>(part.like));
    const Derived derived(part.form, own.size());
    for (std::size_t w = 0; w * wordBytes < own.size(); ++w) {
      const std::uint64_t expected = derived.has(w) ? derived.of(own, w) : wordAt(other, w * wordBytes);
      words.push_back(zigzag(wordAt(own, w * wordBytes) - expected));
    }
  }

  known_.insert_or_assign(next_, std::move(now));
  // Later ones are compared with the newest, and with those whose number is its own with zeros for its last digits.
  std::erase_if(known_, [this](const auto& entry) {
    for (std::uint64_t unit = 1;; unit *= 4) {
      if (entry.first == next_ / unit * unit) return false;
      if (unit > next_) return true;
    }
  });
  ++next_;
  return words;
}

CodedKeyframe::CodedKeyframe(std::span<const std::uint64_t> words, std::uint64_t index) {
  if (words.size() < headWords) {
    fault_ = "has no head";
    return;
  }
  if (words[0] > index) {
    fault_ = "is compared with one that is not before it";
    return;
  }
  if (words[0] > 0) base_ = words[0] - 1;
  parts_ = words[1];
  if (parts_ > maxKeyframeParts || parts_ * descriptionWords > words.size() - headWords) {
    fault_ = "claims more parts than its words can hold";
    return;
  }
  descriptions_ = words.subspan(headWords, static_cast<std::size_t>(parts_) * descriptionWords);
  values_ = words.subspan(headWords + descriptions_.size());
}

std::string CodedKeyframe::decode(std::span<const std::byte> base, std::uint64_t size,
                                  std::vector<std::byte>& out) const {
  out.clear();
  // An unchanged part has no words. It comes from the base, and is no longer than that.
  if (size > base.size() && wordsOf(size - base.size()) > values_.size())
    return "claims more bytes than its words can hold";
  out.resize(static_cast<std::size_t>(size));
  std::size_t done = 0;
  std::size_t value = 0;
  for (std::size_t p = 0; p < parts_; ++p) {
    const auto part = descriptions_.subspan(p * descriptionWords, descriptionWords);
    const std::uint64_t length = part[0];
    const std::uint64_t place = part[1];
    const std::uint64_t like = part[2];
    if (length > out.size() - done) return "has parts of more bytes than it has";
    if (like > length || like > base.size() || place > base.size() - like)
      return "is compared with bytes that are not there";
    if (part[3] > static_cast<std::uint64_t>(PartForm::unchanged)) return "has a part of an unknown form";
    const auto own = std::span(out).subspan(done, static_cast<std::size_t>(length));
    const auto other = base.subspan(static_cast<std::size_t>(place), static_cast<std::size_t>(like));
    done += own.size();
    if (static_cast<PartForm>(part[3]) == PartForm::unchanged) {
      if (like != length) return "has an unchanged part that is not as long as what it is";
      std::copy(other.begin(), other.end(), own.begin());
      continue;
    }
    if (wordsOf(length) > values_.size() - value) return "has fewer words than bytes";
    const Derived derived(static_cast<PartForm>(part[3]), own.size());
    for (const bool following : {false, true}) {
      for (std::size_t w = 0; w * wordBytes < own.size(); ++w) {
        if (derived.has(w) != following) continue;
        const std::uint64_t expected = following ? derived.of(own, w) : wordAt(other, w * wordBytes);
        const std::uint64_t word = expected + unzigzag(values_[value + w]);
        const auto to = own.subspan(w * wordBytes);
        std::memcpy(to.data(), &word, std::min(wordBytes, to.size()));
      }
    }
    value += static_cast<std::size_t>(wordsOf(length));
  }
  return done == out.size() ? "" : "has parts of fewer bytes than it has";
}

}  // namespace calot::recorder
