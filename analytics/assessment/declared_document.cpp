// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/declared_document.h"

#include <algorithm>

#include "recorder/base/file_bytes.h"

namespace calot::analytics {

bool isPlainName(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_' ||
           c == '.';
  });
}

std::string plainName(const recorder::JsonPlace& place) {
  std::string name = place.text(maxName);
  if (!isPlainName(name)) place.fail("a name of letters, digits, points, hyphens and underscores is wanted");
  return name;
}

void readHead(const recorder::JsonObject& root, const std::string& format, std::span<const std::byte> bytes,
              const std::string& file, DeclaredDocument& document) {
  (void)root.at("format").word<int>({{format.c_str(), 0}});
  std::uint32_t formatVersion = 0;
  root.read("formatVersion", formatVersion);
  document.file = file;
  document.text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  document.sha256 = recorder::sha256Hex(bytes);
  document.name = plainName(root.at("name"));
  root.read("version", document.version);
  root.read("title", document.title, maxText);
}

}  // namespace calot::analytics
