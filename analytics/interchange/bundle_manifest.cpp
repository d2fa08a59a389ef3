// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/bundle_manifest.h"

#include <nlohmann/json.hpp>

#include "recorder/attempt.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string bundleManifest(const Bundle& bundle, const std::string& scope) {
  Json leftOut = Json::array(), files = Json::array();
  for (const FlowRow& row : bundle.leftOut) leftOut.push_back({{"reason", row.reason}, {"attempts", row.attempts}});
  for (const WrittenFile& f : bundle.files)
    files.push_back({{"name", f.name}, {"bytes", f.bytes}, {"sha256", f.sha256}});
  return Json{{"format", "calot-bundle"},
              {"formatVersion", 1},
              {"made_by", recorder::softwareName()},
              {"scope", scope},
              {"watermark", bundle.synthetic ? "SYNTHETIC" : ""},
              {"participants", bundle.participants},
              {"attempts", bundle.attempts},
              {"values", bundle.values},
              {"recruited", bundle.recruited},
              {"left_out", leftOut},
              {"smallest_group", bundle.smallest},
              {"names",
               "pseudonyms, attempts and raters have random names that were drawn for this bundle and are "
               "kept nowhere; sites, calibrations and comparability keys are numbered"},
              {"dates",
               "starts are moved by one random length of time a participant, 30 to 365 days earlier or "
               "later, kept nowhere; what lies between a participant's attempts is true"},
              {"withheld",
               "stations, keys, seeds, chain heads, file names, notes, tags, reasons of exclusion, audit, "
               "protocols, norms; words of experience that fewer than three participants share"},
              {"recordings",
               "none: they hold pseudonym, start and station under a content chain that a rewritten "
               "copy would no longer have, and motion by which a person may be known again"},
              {"files", files}}
             .dump(2, ' ', false, Json::error_handler_t::replace) +
         "\n";
}

}  // namespace calot::analytics
