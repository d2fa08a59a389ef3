// SPDX-License-Identifier: GPL-3.0-or-later
// Assessment tables of a cohort database: registered protocols, completed forms and norms
// (schemas/cohort/0004_assessment.sql). CohortDatabase manages participants, attempts and values.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"

namespace calot::analytics {

/// A versioned document: a protocol or a form.
struct StoredDocument {
  std::string name;
  std::uint32_t version = 1;
  std::string sha256;  ///< of the text, hexadecimal
  std::string text;
};

struct RegisteredProtocol : StoredDocument {
  std::string registeredUtc;  ///< by the clock of the machine that registered it
  std::string by;
};

/// One completed form: by a rater about an attempt, or by a participant about their participation.
struct Rating {
  std::string form;
  std::uint32_t formVersion = 1;
  std::string attempt;      ///< uuid, or empty
  std::string rater;        ///< pseudonym, with an attempt
  std::string participant;  ///< pseudonym, without one
  std::map<std::string, int> answers;
  std::string ratedUtc;  ///< set by the database
};

/// Pass mark of one figure within a norm, in SI.
struct NormCheckpoint {
  std::string checkpoint, subject;
  std::uint32_t version = 1;
  Direction direction = Direction::lower;  ///< lower or higher
  bool logScale = false;                   ///< curves of the logarithms
  bool inRule = false;                     ///< counts for the overall judgement
  std::optional<double> cut, lower, upper;
  std::string reason;             ///< why there is no cut, or no interval; else empty
  ExternalMetricRef metric = {};  ///< of a user's own script; none: a checkpoint
};

struct NormMember {
  std::string attempt;  ///< uuid
  bool competent = false;
  std::vector<std::optional<double>> values;  ///< by Norm::checkpoints, in SI
};

struct NormEvidence {
  std::string statement, fileName, sha256, by, attachedUtc;
};

/// A named, versioned reference cohort, frozen when it was made.
struct Norm {
  std::string name;
  std::uint32_t version = 1;  ///< set by the database
  std::string comparabilityKey;
  std::string judgedBy;           ///< what says who is competent
  std::uint32_t leastPassed = 0;  ///< of the checkpoints in the rule; 0: all
  std::uint64_t membersMade = 0;  ///< when it was made; withdrawn since: this - members.size()
  bool synthetic = false;
  std::uint64_t seed = 1;
  std::string createdUtc, by;
  std::vector<NormCheckpoint> checkpoints;
  std::vector<NormMember> members;
  std::vector<NormEvidence> evidence;
};

/// One connection of its own; errors as CohortDatabase. Every changing call is one transaction and is audited.
class AssessmentDatabase {
 public:
  AssessmentDatabase(const std::string& path, CohortDatabase::Access access,
                     std::chrono::milliseconds patience = std::chrono::seconds(10));
  ~AssessmentDatabase();
  AssessmentDatabase(const AssessmentDatabase&) = delete;
  AssessmentDatabase& operator=(const AssessmentDatabase&) = delete;

  /// Stores a protocol with the current time. Storing the same text again changes nothing and returns the stored one.
  /// @param[out] added whether it is new
  /// @throws Error (refused) where this version, or a higher one, is there with another text; Error (invalid) where
  /// nobody registers.
  RegisteredProtocol registerProtocol(const StoredDocument& protocol, const std::string& by, bool& added);
  /// By version; of all names by name where none is given.
  [[nodiscard]] std::vector<RegisteredProtocol> protocols(const std::string& name = "") const;

  /// Stores one filled form and the form itself where it is not there yet.
  /// @throws Error (refused) where this form's version is there with another text, there is no such attempt or
  /// participant, or the same rater (participant) has filled it before and `replace` is not set; Error (invalid) for a
  /// malformed rater.
  void storeRating(const StoredDocument& form, const Rating& rating, bool replace);
  /// Several in one transaction: all of them or none. @param ratings each with the number of its form
  void storeRatings(const std::vector<StoredDocument>& forms,
                    const std::vector<std::pair<std::size_t, Rating>>& ratings, bool replace);
  [[nodiscard]] std::vector<Rating> ratings() const;        ///< by form, version, attempt, rater, participant
  [[nodiscard]] std::vector<StoredDocument> forms() const;  ///< by name, version

  /// Stores a norm as the next version of its name. @return that version
  /// @throws Error (refused) where a member's attempt is not there; Error (invalid) for a malformed name, or where
  /// nobody makes it.
  std::uint32_t storeNorm(const Norm& norm);
  [[nodiscard]] std::vector<Norm> norms() const;  ///< by name, version; whole
  /// The newest version where none is given. @throws Error (refused) where there is none.
  [[nodiscard]] Norm norm(const std::string& name, std::uint32_t version = 0) const;
  /// @throws Error (refused) where there is no such norm; Error (invalid) where the statement or who attaches it is
  /// empty.
  void attachEvidence(const Norm& norm, const NormEvidence& evidence);

 private:
  std::unique_ptr<CohortConnection> connection_;
};

}  // namespace calot::analytics
