// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "analytics/report/report_document.h"

namespace calot::analytics {

/// One page that needs nothing else: no scripts, one style, figures inline, every text escaped; watermarked where the
/// report is synthetic.
std::string pageHtml(const ReportDocument& document);

}  // namespace calot::analytics
