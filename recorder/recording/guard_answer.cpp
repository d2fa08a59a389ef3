// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/guard_answer.h"

#include <array>
#include <cstddef>
#include <new>
#include <stdexcept>
#include <utility>
#include <vector>

namespace calot::recorder {

namespace {

constexpr char succeeded = 'r', failed = 'e';

/// An error as text: one character for its kind, one for the number of its remedies, one for each of them, then file,
/// place and fault, each ended by a zero byte.
std::string packedError(const Error& error) {
  std::string text{failed, static_cast<char>(error.kind()), static_cast<char>(error.remedies().size())};
  for (const Remedy remedy : error.remedies()) text += static_cast<char>(remedy);
  for (const std::string& part : {error.where().file, error.where().place, error.fault()})
    text += part.substr(0, part.find('\0')) + '\0';
  return text;
}

std::optional<Error> unpackedError(const std::string& text) {
  if (text.size() < 3 || text[0] != failed ||
      static_cast<unsigned char>(text[1]) > static_cast<unsigned char>(ErrorKind::undecided))
    return std::nullopt;
  std::size_t at = 3;
  std::vector<Remedy> remedies;
  for (std::size_t end = at + static_cast<unsigned char>(text[2]); at < end && at < text.size(); ++at)
    remedies.push_back(static_cast<Remedy>(text[at]));
  std::array<std::string, 3> part;
  for (std::string& one : part) {
    const std::size_t end = text.find('\0', at);
    if (end == std::string::npos) return std::nullopt;
    one = text.substr(at, end - at);
    at = end + 1;
  }
  return Error(static_cast<ErrorKind>(text[1]), Where{part[0], part[1]}, part[2], std::move(remedies));
}

/// The reading library says in words of its own that it had no memory.
bool isOfMemory(const Error& error) { return error.fault().find("memory allocation failed") != std::string::npos; }

}  // namespace

std::string packedAnswer(const std::string& what, const std::function<std::string()>& task,
                         const std::function<Error(const Where&)>& noMemory) {
  try {
    return succeeded + task();
  } catch (const Error& e) {
    return packedError(isOfMemory(e) ? noMemory(e.where()) : e);
  } catch (const std::bad_alloc&) {
    return packedError(noMemory(Where{what}));
  } catch (const std::length_error&) {
    return packedError(noMemory(Where{what}));
  } catch (const std::exception& e) {
    return packedError(Error(ErrorKind::failure, e.what()));
  }
}

std::optional<std::string> unpackedAnswer(const std::string& packed) {
  if (!packed.empty() && packed[0] == succeeded) return packed.substr(1);
  if (const auto error = unpackedError(packed)) throw *error;
  return std::nullopt;
}

}  // namespace calot::recorder
