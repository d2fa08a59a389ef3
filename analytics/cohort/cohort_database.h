// SPDX-License-Identifier: GPL-3.0-or-later
// The cohort database: participants, attempts, recordings' identities and checkpoint values, protocols, forms and
// norms, in one SQLite file (docs/reference/cohort.md, schemas/cohort/*.sql); its check, and merging two (merge.cpp).
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/uncertainty/value_interval.h"

namespace calot::analytics {

/// Verdict of a replay on a recording. Values are stored and never reused.
enum class Verdict : std::uint8_t {
  verified = 0,          ///< every digest and force equal, bit for bit
  diverged = 1,          ///< chain broken or a difference
  damaged = 2,           ///< unreadable or a bad checksum
  notCheckableHere = 3,  ///< another simulation version
  notChecked = 4,
};
std::string nameOf(Verdict verdict);  ///< "verified", "diverged", "damaged", "not checkable here", "not checked"

struct Verification {
  Verdict verdict = Verdict::notChecked;
  std::string text;      ///< one line: where it diverged, what is damaged; or empty
  std::string software;  ///< judging program: "calot 0.1.0"
};

/// A person behind a pseudonym. Experience is recorded as criteria ("laparoscopies" = "240"), never as a label alone.
struct Participant {
  std::string pseudonym;
  std::string group;  ///< study group ("expert", "novice"), or empty
  std::string arm;
  std::string site;
  std::map<std::string, std::string> experience;
  std::map<std::string, std::string> consent;  ///< purpose -> date (YYYY-MM-DD)
  bool operator==(const Participant&) const = default;
};

/// @throws Error (invalid) for an empty or malformed pseudonym, a criterion or purpose without name, or no date.
void checkParticipant(const Participant& participant);

/// Fields that setParticipant() changes; empty ones are left unchanged.
struct ParticipantChange {
  std::optional<std::string> group, arm, site;
  std::map<std::string, std::string> experience;
  std::map<std::string, std::string> consent;
};

/// A station's valid Ed25519 signature of a recording's chain head.
struct RecordingSignature {
  std::array<std::byte, 32> publicKey{};
  std::array<std::byte, 64> value{};
  bool operator==(const RecordingSignature&) const = default;
};

/// An attempt as the database knows it from its recording.
struct AttemptRecord {
  std::string uuid;
  std::string parent;       ///< uuid, or empty
  std::string participant;  ///< pseudonym, or empty
  std::string scene;
  std::uint32_t sceneMajor = 0, sceneMinor = 0;
  recorder::OperatorKind operatorKind = recorder::OperatorKind::performer;
  std::string profile, profileVersion;  ///< performer's
  recorder::Mode mode = recorder::Mode::practice;
  std::string purpose;
  recorder::Outcome outcome = recorder::Outcome::running;
  std::string startUtc;  ///< ISO 8601 with Z
  std::uint64_t seed = 0;
  std::string device;  ///< class
  std::string calibration;
  std::string station;  ///< where it was recorded, or empty
  std::uint32_t simulationVersion = 0;
  std::string comparabilityKey;
  bool synthetic = false;  ///< made by a performer

  std::string fileName;  ///< of the recording, without folder
  bool complete = false;
  std::uint64_t steps = 0;
  double stepSeconds = 0.01;
  std::array<std::byte, 32> chainHead{};  ///< BLAKE2b-256 of the content
  std::optional<RecordingSignature> signature;
  Verification verification;
};

/// A rule that leaves an attempt out of studies: a row of the view attempt_left_out
/// (schemas/cohort/0011_analysis_set.sql), the definition of what is analysed.
struct LeftOut {
  std::int64_t position = 0;  ///< order in which studies count the rules
  std::string rule;           ///< "practice"
  std::string reason;
};

/// Imported motion: there is no simulation, and what is known of it beside the samples was stated by hand.
inline bool isMotion(const AttemptRecord& attempt) { return attempt.simulationVersion == 0; }

/// Evidence of an attempt's start: "signed" or "recorded" within its chain, "stated", or "unknown". A recording of
/// a motion file has the time of its making, not of the motion's: that is stated, too.
const char* startEvidence(const AttemptRecord& attempt);

/// A row of the list of attempts, with what the database adds.
struct AttemptRow : AttemptRecord {
  std::string group, arm, site;   ///< the participant's
  std::string verifiedUtc;        ///< when the verdict was reached
  std::string importedUtc;        ///< when the attempt first came in
  bool withdrawn = false;         ///< the participant has withdrawn from research
  bool excluded = false;          ///< by hand, or withdrawn
  std::string exclusionReason;    ///< reason and by whom
  std::vector<std::string> tags;  ///< words to find it by, in the order of their bytes
  std::vector<LeftOut> leftOut;   ///< by position; empty: in the analysis set
};

/// One value of a row in a list for people or other programs; enumerations by their words.
using FieldValue = std::variant<std::monostate, bool, std::int64_t, std::uint64_t, double, std::string,
                                std::vector<std::string>, std::map<std::string, std::string>>;
using Fields = std::vector<std::pair<std::string, FieldValue>>;
/// A row by the names that lists give its columns: those that declared_tables.cpp declares, then what several of them
/// say together.
Fields fieldsOf(const AttemptRow& attempt);
Fields fieldsOf(const Participant& participant);
Fields fieldsOf(const CheckpointValue& value);

/// A tag is one word: 1 to 40 characters, no blank, comma or control character. @throws Error (invalid)
void checkTag(const std::string& tag);

/// Result of storeAttempt().
enum class Imported : std::uint8_t { added, unchanged, extended };

struct GroupCount {
  std::string group;  ///< "" for attempts without participant or group
  std::uint64_t participants = 0;
  std::uint64_t attempts = 0;
};

/// One value with the attempt that it belongs to.
struct AttemptValue {
  std::string attempt;
  CheckpointValue value;
  std::optional<ValueInterval> interval = {};  ///< of this value, where one was worked out
};

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
  std::string withdrawnUtc = {};  ///< empty: it stands
};

/// One completed form: by a rater about an attempt, or by a participant about their participation.
struct Rating {
  std::string form;
  std::uint32_t formVersion = 1;
  std::string attempt;      ///< uuid, or empty
  std::string rater;        ///< pseudonym, with an attempt
  std::string participant;  ///< pseudonym, without one
  std::map<std::string, int> answers;
  std::string ratedUtc = {};            ///< set by the database
  std::optional<double> filmSeen = {};  ///< share of the film that ran before the rater, for the audit; not read back
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

struct CohortConnection;

/// One connection to a cohort database: pages with checksums, foreign keys, strict tables. Two processes may write at
/// once (the second waits); between two writes the file alone is the whole database. Every modifying call is one
/// transaction, so that a killed process leaves no partial change. Not thread-safe: open one connection per thread.
///
/// Every call throws calot::Error with the file's name: 4 (missing, not a database, another program's database,
/// corrupt), 5 (schema of a newer Calot), 3 (conflict), 1 (locked beyond the waiting time, read-only, disk full).
class CohortDatabase {
 public:
  enum class Access : std::uint8_t {
    read,    ///< must exist; nothing is changed
    write,   ///< must exist; older schemas are migrated
    create,  ///< as write, and created if it does not exist
  };

  CohortDatabase(const std::string& path, Access access, std::chrono::milliseconds patience = std::chrono::seconds(10));
  ~CohortDatabase();
  CohortDatabase(CohortDatabase&&) noexcept;
  CohortDatabase& operator=(CohortDatabase&&) noexcept;

  /// Number of migrations applied.
  [[nodiscard]] int schemaVersion() const;
  [[nodiscard]] const std::string& path() const;

  /// Adds a participant. @throws Error (refused) if the pseudonym is taken; Error (invalid) for an empty or malformed
  /// pseudonym or date.
  void addParticipant(const Participant& participant);
  /// Changes what is given. @throws Error (refused) if there is no such participant.
  void setParticipant(const std::string& pseudonym, const ParticipantChange& change);
  [[nodiscard]] std::vector<Participant> participants() const;  ///< by pseudonym

  /// Adds the attempt with its values, or brings what is known of the same recording up to date (a recovered or longer
  /// file of the same uuid); one transaction. Running it again changes nothing. A participant unknown so far is added
  /// without group.
  /// @throws Error (refused) "conflict" when the same uuid came in before with another content of the same length, or
  /// with another scene, seed, participant or operator; or when it, or what it branches from, was withdrawn.
  Imported storeAttempt(const AttemptRecord& attempt, const std::vector<CheckpointValue>& values);
  /// Replaces the attempt's values. @throws Error (refused) if there is no such attempt.
  void storeValues(const std::string& attempt, const std::vector<CheckpointValue>& values);
  /// Replaces the intervals of the attempt's values. @throws Error (refused) if there is no such attempt.
  void storeIntervals(const std::string& attempt, const std::vector<ValueInterval>& intervals);

  /// Stores what external metrics gave of an attempt, in one transaction; a metric that is new here is registered with
  /// its SHA-256. A value of an earlier version is kept and hidden by the newer one's. Running it again changes
  /// nothing.
  /// @pre values are of origin `external`
  /// @throws Error (refused) as checkMetric(), where the stored value of this version is another one, or there is no
  /// such attempt.
  Imported storeExternal(const std::string& attempt, const std::vector<CheckpointValue>& values);
  /// @throws Error (refused) where the version is registered with another source, or a later one is. The message is
  /// about the script.
  void checkMetric(const ExternalMetric& metric) const;
  [[nodiscard]] std::vector<ExternalMetric> externalMetrics() const;  ///< all versions, by name and version

  /// Marks attempts as excluded from studies, or replaces the mark; all or none, each audited. @throws Error (invalid)
  /// without reason or name; (refused) if there is no such attempt.
  void excludeAttempts(const std::vector<std::string>& attempts, const std::string& reason, const std::string& by);
  /// Removes the marks; all or none, each audited. @throws Error as excludeAttempts, and (refused) if one is not
  /// excluded.
  void includeAttempts(const std::vector<std::string>& attempts, const std::string& reason, const std::string& by);

  /// Puts a word on attempts, by which people find them again; nothing is computed from it. All or none, each audited.
  /// @returns how many did not have it yet @throws Error (invalid) as checkTag(), or without name; (refused) if there
  /// is no such attempt.
  std::size_t tagAttempts(const std::vector<std::string>& attempts, const std::string& tag, const std::string& by);
  /// Takes it off again. @returns how many had it @throws Error as tagAttempts
  std::size_t untagAttempts(const std::vector<std::string>& attempts, const std::string& tag, const std::string& by);

  /// The uuid under which the cohort knows imported motion: `uuid` itself, that of the attempt whose file had these
  /// bytes (read by another map, or by an earlier version), or `earlier` if an attempt of that uuid was withdrawn.
  [[nodiscard]] std::string uuidOfMotion(const std::string& uuid, const std::string& earlier,
                                         const std::array<std::byte, 32>& bytesHash) const;
  /// The uuid that begins with `text`. @throws Error (refused) if there is none, or more than one.
  [[nodiscard]] std::string attemptNamed(const std::string& text) const;
  [[nodiscard]] std::vector<AttemptRow> listAttempts() const;  ///< by start, then uuid
  [[nodiscard]] std::optional<AttemptRow> attempt(const std::string& uuid) const;
  /// An attempt's values in the order in which they were stored (the registry's), then those of external metrics by
  /// name.
  [[nodiscard]] std::vector<CheckpointValue> values(const std::string& attempt) const;
  /// Intervals of the attempt's present values, in their order; none of a value that has changed since.
  [[nodiscard]] std::vector<ValueInterval> intervals(const std::string& attempt) const;
  /// Values of all attempts with their intervals, by attempt, then in the order of values(). @param without names of
  /// checkpoints to leave out.
  [[nodiscard]] std::vector<AttemptValue> allValues(const std::vector<std::string>& without = {}) const;
  /// The same one after the other, for cohorts whose values need not be in memory at once. @param take may throw, which
  /// ends it; what it is given is good until it returns
  void eachValue(const std::vector<std::string>& without, const std::function<void(const AttemptValue&)>& take) const;
  /// Values of one checkpoint alone, one an attempt, by the attempt's uuid.
  [[nodiscard]] std::map<std::string, CheckpointValue> valuesOf(std::string_view checkpoint) const;
  [[nodiscard]] std::vector<GroupCount> groups() const;  ///< by name

  // Registered protocols, completed forms and norms (schemas/cohort/0004_assessment.sql).

  /// Stores a protocol with the current time. Storing the same text again changes nothing and returns the stored one.
  /// @param[out] added whether it is new
  /// @throws Error (refused) where this version, or a higher one that stands, is there with another text; Error
  /// (invalid) where nobody registers.
  RegisteredProtocol registerProtocol(const StoredDocument& protocol, const std::string& by, bool& added);
  /// By version; of all names by name where none is given.
  [[nodiscard]] std::vector<RegisteredProtocol> protocols(const std::string& name = "") const;
  /// Withdraws a registered protocol, audited; its row stays. @pre it is registered and stands
  /// @throws Error (invalid) without reason or name
  void withdrawProtocol(const std::string& sha256, const std::string& reason, const std::string& by);

  /// Stores one filled form and the form itself where it is not there yet.
  /// @throws Error (refused) where this form's version is there with another text, there is no such attempt or
  /// participant, or the same rater (participant) has filled it before and `replace` is not set; Error (invalid) for a
  /// malformed rater.
  void storeRating(const StoredDocument& form, const Rating& rating, bool replace);
  /// Several in one transaction: all of them or none. @param ratings each with the number of its form
  void storeRatings(const std::vector<StoredDocument>& forms,
                    const std::vector<std::pair<std::size_t, Rating>>& ratings, bool replace);
  /// Takes a completed form back, audited. @param rating its form, version, and attempt with rater, or participant
  /// @throws Error (refused) where it is not there
  void removeRating(const Rating& rating);
  [[nodiscard]] std::vector<Rating> ratings() const;        ///< by form, version, attempt, rater, participant
  [[nodiscard]] std::vector<StoredDocument> forms() const;  ///< by name, version

  /// Stores a norm as the next version of its name. @return that version
  /// @throws Error (refused) where a member's attempt is not there; Error (invalid) for a malformed name, or where
  /// nobody makes it.
  std::uint32_t storeNorm(const Norm& norm);
  /// Takes the newest version of a norm out again, audited. Its number is given again to the next version.
  /// @throws Error (refused) where there is no such norm, it is not the newest version, or it has evidence; Error
  /// (invalid) without name of who removes it
  void removeNorm(const std::string& name, std::uint32_t version, const std::string& by);
  [[nodiscard]] std::vector<Norm> norms() const;  ///< by name, version; whole
  /// The newest version unless one is given. @throws Error (refused) where there is none.
  [[nodiscard]] Norm norm(const std::string& name, std::uint32_t version = 0) const;
  /// @throws Error (refused) where there is no such norm; Error (invalid) where the statement or who attaches it is
  /// empty.
  void attachEvidence(const Norm& norm, const NormEvidence& evidence);

 private:
  std::unique_ptr<CohortConnection> connection_;
};

/// "touch-liver/1 device=falcon calibration=- simulation=1 results=1 mode=assessment": attempts are compared only
/// within one key. Checkpoint versions belong to the key too; they stand beside each value, so that a new version of
/// one checkpoint separates that checkpoint's values and no others.
std::string comparabilityKey(const recorder::AttemptHeader& header);

/// The same in words: "task touch-liver 1, device falcon, no calibration, simulation 1, step results 1, mode
/// assessment"; imported motion has no simulation. A text that is no such key is given back as it is.
std::string comparabilityWords(const std::string& key);

/// Result of checking a whole cohort database.
struct CohortCheck {
  int schema = 0;
  std::uint64_t participants = 0, attempts = 0, values = 0;
  std::vector<std::string> faults;  ///< problems, one line each; empty: the database is sound
};

/// Sums of its pages, a schema that is this program's, SQLite's integrity check (with the constraints of every column),
/// foreign keys, numbers that the program never writes, attempts without a recording, and signatures that are not of
/// the recording's head. Changes nothing. @throws Error as CohortDatabase does.
CohortCheck checkCohort(const std::string& path);

/// Before figures of a database are shown. @throws Error (damaged) naming the first fault of checkCohort()
void refuseUnsound(const std::string& path);

struct CohortMerge {
  std::uint64_t participants = 0, attempts = 0;  ///< taken in
  std::uint64_t extended = 0;                    ///< attempts that the other database had longer, or judged
  std::uint64_t rows = 0;                        ///< of all other tables, taken in
  std::uint64_t audit = 0;                       ///< rows of the audit trail, which carry no new content
  std::uint64_t filled = 0;                      ///< entries that were empty here
  std::uint64_t withdrawn = 0;                   ///< attempts that were withdrawn here and stay out
  std::vector<std::string> conflicts;            ///< one line each; then nothing was merged

  [[nodiscard]] bool changed() const { return participants + attempts + extended + rows + filled > 0; }
};

/// Takes everything of one database into another, made if it is missing, in one transaction. Rows are the
/// same where their keys are: a pseudonym, a uuid, a name; never the numbers of rows. Of an attempt in both, the longer
/// recording counts and the values that are there stay. Doing it again changes nothing. Where both say different things
/// of one row, that is a conflict, every one is reported, and nothing is merged.
/// @throws Error as CohortDatabase does; (invalid) where both are one file.
CohortMerge mergeCohorts(const std::string& into, const std::string& from);

}  // namespace calot::analytics
