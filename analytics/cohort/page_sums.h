// SPDX-License-Identifier: GPL-3.0-or-later
// Cohort databases end each page with a checksum (docs/reference/cohort-pages.md): SQLite keeps its 8 reserved bytes
// free, and this file layer writes them and compares them whenever a page is read. It also says in the first page that
// a commit is under way, and locks by a folder where the file system grants no locks.
#pragma once

#include <optional>
#include <string>

#include "recorder/base/errors.h"

struct sqlite3;

namespace calot::analytics {

/// Name of the file layer, for opening a database. A database without sums is read and written as it is.
const char* pageSumLayer();

/// Do its pages have sums?
bool hasPageSums(sqlite3* database);
/// Its pages shall have sums: of a new one at once, of another from the next VACUUM on. @pre without a write-ahead log,
/// and that VACUUM spills no pages, so that the first page, which says whether there are sums, is written first and is
/// the first to be taken back
void askForPageSums(sqlite3* database);

/// The fault behind the newest failure of SQLite in this thread, where this layer knows it better; given once.
std::optional<Error> layersFault();

}  // namespace calot::analytics
