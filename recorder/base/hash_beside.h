// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <future>
#include <span>
#include <string>

#include "recorder/base/files.h"

namespace calot::recorder {

/// sha256Hex() of bytes, worked out while the caller goes on. @pre the bytes outlive it
class HashBeside {
 public:
  explicit HashBeside(std::span<const std::byte> bytes)
      : hash_(std::async(std::launch::async, [bytes] { return sha256Hex(bytes); })) {}
  std::string get() { return hash_.get(); }

 private:
  std::future<std::string> hash_;
};

}  // namespace calot::recorder
