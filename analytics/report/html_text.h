// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace calot::analytics {

/// A text for HTML or SVG, between tags or in a quoted attribute: & < > " ' are escaped, control characters and bytes
/// that are not UTF-8 become U+FFFD.
std::string escaped(std::string_view text);

}  // namespace calot::analytics
