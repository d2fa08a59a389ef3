// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "analytics/report/report_document.h"

namespace calot::analytics {

/// A recording that a page carries as data, for calot-page.html to open (docs/how-to/page.md).
struct CarriedRecording {
  std::string name;  ///< of the file
  std::span<const std::byte> bytes;
};

/// One page that needs nothing else: no scripts, one style, figures inline, every text escaped; watermarked where the
/// report is synthetic. @param recording null: none
std::string pageHtml(const ReportDocument& document, const CarriedRecording* recording = nullptr);

}  // namespace calot::analytics
