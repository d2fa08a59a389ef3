// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of a page that needs nothing else: no scripts, one style, every text escaped.
#pragma once

#include <string>
#include <vector>

#include "analytics/report/study_tables.h"

namespace calot::analytics {

/// From the document's type to the heading, with the watermark where it is synthetic.
std::string pageBegin(const std::string& title, bool synthetic);
std::string pageEnd(bool synthetic);
std::string watermarkHtml(bool synthetic);  ///< empty where it is not
std::string paragraphHtml(const std::string& text);
std::string listHtml(const std::vector<std::string>& items);
/// A heading and the table below it.
std::string tableHtml(const ReportTable& table);

}  // namespace calot::analytics
