// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/declared_document.h"

#include "recorder/base/files.h"

namespace calot::analytics {

void keepText(std::span<const std::byte> bytes, const std::string& file, DeclaredDocument& document) {
  document.file = file;
  document.text.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  document.sha256 = recorder::sha256Hex(bytes);
}

}  // namespace calot::analytics
