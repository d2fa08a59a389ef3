// SPDX-License-Identifier: GPL-3.0-or-later
// Attempts of a cohort as statements of the Experience API, which learning record stores take.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calot::analytics {

struct XapiOptions {
  /// Begin of the site's identifiers, an absolute IRI such as "https://training.example.org": home page of the
  /// participants' accounts; activities and extensions stand below it.
  std::string home;
  bool includeSynthetic = false;  ///< performers' attempts, too
};

struct XapiStatements {
  std::string json;                   ///< an array of statements
  std::vector<std::string> attempts;  ///< uuids of those told
  std::uint64_t recruited = 0;        ///< attempts in the database
};

/// One statement an attempt (xAPI 1.0.3; docs: "Statements for a learning record store"): its id is the attempt's uuid,
/// the actor the participant's pseudonym as an account, the verb "completed" or else "attempted", the object the scene
/// and its major version; the result has completion, duration and every value of a checkpoint in SI units; the context
/// says mode, device, key, versions, verification and whether it is synthetic. Left out are attempts without
/// participant, excluded ones and those of whom withdrew; of performers' attempts the profile is the actor.
/// @throws Error as CohortDatabase; (invalid) where `home` is no IRI; (refused) where nothing is left
XapiStatements xapiStatements(const std::string& database, const XapiOptions& options);

}  // namespace calot::analytics
