// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/hdf5.h"

#include <fmt/format.h>

namespace calot::recorder::hdf5 {

std::mutex& processLock() {
  static std::mutex lock;
  return lock;
}

Session::Session() : lock_(processLock()) { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

namespace {

extern "C" herr_t calotCollectReason(unsigned /*depth*/, const H5E_error2_t* error, void* out) {
  auto& text = *static_cast<std::string*>(out);
  const std::string description = error->desc != nullptr ? error->desc : "";
  if (text == "bad checksum") return 0;
  if (description.find("hecksum") != std::string::npos || description.find("inflate()") != std::string::npos) {
    text = "bad checksum";
    return 0;
  }
  constexpr const char* key = "error message = '";
  if (const auto at = description.find(key); at != std::string::npos) {
    const auto begin = at + std::char_traits<char>::length(key);
    text = description.substr(begin, description.find('\'', begin) - begin);
  } else if (text.empty()) {
    text = description;
  }
  return 0;
}

}  // namespace

std::string reason() {
  std::string text;
  // Upward: innermost call first.
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, calotCollectReason, &text);
  return text.empty() ? "unknown reason" : text;
}

Error damaged(const std::filesystem::path& file, const std::string& place, const std::string& what) {
  return {ErrorKind::damaged, Where{file.string(), place}, what};
}

}  // namespace calot::recorder::hdf5
