// SPDX-License-Identifier: GPL-3.0-or-later
// Texts and JSON of tests.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace calot::analytics::support {

inline std::vector<std::byte> bytesOf(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

inline nlohmann::json jsonOf(const std::string& file) {
  std::ifstream in(std::string(CALOT_SOURCE_DIR) + "/" + file);
  EXPECT_TRUE(in) << file;
  return nlohmann::json::parse(in);
}

}  // namespace calot::analytics::support
