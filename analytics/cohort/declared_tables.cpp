// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/declared_tables.h"

#include "analytics/cohort/column_members.h"

namespace calot::analytics {

namespace {

constexpr const char *text = "TEXT NOT NULL", *integer = "INTEGER NOT NULL", *real = "REAL NOT NULL",
                     *blob = "BLOB NOT NULL";
constexpr const char *integerOrNull = "INTEGER", *realOrNull = "REAL", *blobOrNull = "BLOB";
constexpr const char *utc = "ISO 8601 UTC with Z", *yesNo = "0 no, 1 yes";
constexpr const char* kindsOfMissing =
    "0 value, 1 not applicable, 2 not available, 3 absent hand, 4 too little coverage";

/// Tables that no struct holds.
const std::vector<DeclaredTable>& furtherTables() {
  static const std::vector<DeclaredTable> tables{
      {"participant_experience",
       {{"participant", integer, "row of participant"},
        {"criterion", text, "what was asked, as laparoscopies"},
        {"value", text, "the answer"}}},
      {"consent",
       {{"participant", integer, "row of participant"},
        {"purpose", text, "what for, as research"},
        {"given_on", text, "day of consent", {}, "", "YYYY-MM-DD"}}},
      {"exclusion",
       {{"attempt", integerOrNull, "row of attempt"},
        {"reason", text, "why it stays out of studies"},
        {"excluded_by", text, "by whose word"},
        {"excluded_utc", text, "when", {}, "", utc}}},
      {"attempt_tag", {{"attempt", integer, "row of attempt"}, {"tag", text, "word that people find it by"}}},
      {"audit",
       {{"id", integerOrNull, "number of the row"},
        {"at_utc", text, "when", {}, "", utc},
        {"action", text, "what was done, as attempt-import"},
        {"subject", text, "pseudonym, uuid or name that it was done to"},
        {"detail", text, "what exactly", {}, "", "", "empty"}}},
      {"site", {{"name", text, "name of the site"}, {"note", text, "a word on it", {}, "", "", "empty"}}},
      {"arm", {{"name", text, "name of the study arm"}, {"note", text, "a word on it", {}, "", "", "empty"}}},
      {"cohort", {{"name", text, "name of the cohort"}, {"note", text, "a word on it", {}, "", "", "empty"}}},
      {"cohort_participant", {{"cohort", text, "name of the cohort"}, {"participant", integer, "row of participant"}}},
      {"export",
       {{"id", integerOrNull, "number of the row"},
        {"at_utc", text, "when", {}, "", utc},
        {"kind", text, "what was written, as study-csv"},
        {"target", text, "file or folder"}}},
      {"export_attempt", {{"export", integer, "row of export"}, {"attempt", integer, "row of attempt"}}},
      {"research_withdrawal",
       {{"participant", integerOrNull, "row of participant"}, {"withdrawn_utc", text, "when", {}, "", utc}}},
      {"tombstone",
       {{"id", text, "random number of the withdrawal"},
        {"withdrawn_utc", text, "when", {}, "", utc},
        {"scope", text, "what went", {}, "", "research, all"},
        {"attempts", integer, "how many attempts went"}}},
      {"tombstone_attempt",
       {{"digest", blob, "BLAKE2b-256 of the uuid of an attempt that was withdrawn"},
        {"tombstone", text, "id of tombstone"}}},
      {"rating",
       {{"form", integer, "row of form"},
        {"attempt", integer, "row of attempt"},
        {"rater", text, "pseudonym of the rater"},
        {"item", text, "key of the item"},
        {"score", integer, "score", {}, "", "whole numbers of the form's scale", "an item left blank has no row"},
        {"rated_utc", text, "when", {}, "", utc}}},
      {"questionnaire",
       {{"form", integer, "row of form"},
        {"participant", integer, "row of participant"},
        {"item", text, "key of the item"},
        {"score", integer, "score", {}, "", "whole numbers of the form's scale", "an item left blank has no row"},
        {"rated_utc", text, "when", {}, "", utc}}},
      {"rating_pack",
       {{"id", text, "random name of the pack"},
        {"form", text, "name of the form in it"},
        {"form_version", integer, "its version"},
        {"form_sha256", text, "SHA-256 of its text"},
        {"form_text", text, "the form, byte for byte"},
        {"packed_utc", text, "when", {}, "", utc}}},
      {"rating_pack_rater",
       {{"pack", text, "name of the pack"},
        {"rater", text, "pseudonym of the rater"},
        {"seal_key", blob, "random key with which the rater's page seals the answers"},
        {"taken_utc", text, "when the answers were stored", {}, "", utc, "empty: not yet"}}},
      {"rating_pack_film",
       {{"pack", text, "name of the pack"},
        {"rater", text, "pseudonym of the rater"},
        {"name", text, "random name of the film"},
        {"position", integer, "place in the order in which the rater sees the films, from 0"},
        {"attempt", integer, "row of attempt"}}},
      {"group_mask",
       {{"protocol_sha256", text, "SHA-256 of the protocol's text"},
        {"swapped", integer, "the protocol's second population is group 1", {}, "", yesNo},
        {"drawn_utc", text, "when", {}, "", utc}}},
      {"norm_member",
       {{"norm", integer, "row of norm"},
        {"attempt", integer, "row of attempt"},
        {"competent", integer, "judged competent", {}, "", yesNo}}},
      {"norm_value",
       {{"norm", integer, "row of norm"},
        {"attempt", integer, "row of attempt"},
        {"checkpoint", text, "checkpoint"},
        {"subject", text, "hand, organ or phase", {}, "", "", "empty: the attempt as a whole"},
        {"value", real, "value when the norm was made, in the checkpoint's SI unit"}}}};
  return tables;
}

}  // namespace

// name, type, meaning, member, unit, allowed values, what stands where there is none
const TableOf<Participant>& participantTable() {
  using R = Participant;
  static const TableOf<R> table{{"participant",
                                 {{"id", integerOrNull, "number of the row, which other tables name"},
                                  {"pseudonym", text, "pseudonym", at<R, &R::pseudonym>},
                                  {"study_group", text, "study group", at<R, &R::group>, "", "", "empty"},
                                  {"arm", text, "study arm", at<R, &R::arm>, "", "", "empty"},
                                  {"site", text, "where the participant belongs", at<R, &R::site>, "", "", "empty"},
                                  {"created_utc", text, "when the row was made", {}, "", utc}}}};
  return table;
}

const TableOf<AttemptRecord>& attemptTable() {
  using R = AttemptRecord;
  static const TableOf<R> table{
      {"attempt",
       {{"id", integerOrNull, "number of the row, which other tables name"},
        {"uuid", text, "identity of the attempt", at<R, &R::uuid>},
        {"parent_uuid", text, "attempt that it branches from", at<R, &R::parent>, "", "", "empty"},
        {"participant", integerOrNull, "row of participant", {}, "", "", "empty"},
        {"scene", text, "scene, or declared task of imported motion", at<R, &R::scene>},
        {"scene_major", integer, "version of the scene that comparison asks for", at<R, &R::sceneMajor>},
        {"scene_minor", integer, "version of the scene within it", at<R, &R::sceneMinor>},
        {"operator_kind", integer, "who acted", at<R, &R::operatorKind>, "", "0 human, 1 kinematics, 2 performer"},
        {"profile", text, "profile of a performer", at<R, &R::profile>, "", "", "empty"},
        {"profile_version", text, "version of the profile", at<R, &R::profileVersion>, "", "", "empty"},
        {"mode", integer, "mode", at<R, &R::mode>, "", "0 practice, 1 assessment"},
        {"purpose", text, "what it was for, as training", at<R, &R::purpose>, "", "", "empty"},
        {"outcome", integer, "how it ended", at<R, &R::outcome>, "",
         "0 running, 1 completed, 2 time limit, 3 abandoned, 4 stopped, 5 technical failure"},
        {"start_utc", text, "when it began", at<R, &R::startUtc>, "", utc, "empty"},
        {"seed", text, "seed of the simulation, unsigned 64 bits in decimal", digits<R, &R::seed>},
        {"device", text, "class of device", at<R, &R::device>, "", "", "empty"},
        {"calibration", text, "calibration of the device", at<R, &R::calibration>, "", "", "empty"},
        {"simulation_version", integer, "version of the simulation; 0: motion without a scene",
         at<R, &R::simulationVersion>},
        {"comparability_key", text, "attempts are compared within one key only", at<R, &R::comparabilityKey>},
        {"synthetic", integer, "made by a performer", at<R, &R::synthetic>, "", yesNo},
        {"imported_utc", text, "when it first came in", {}, "", utc},
        {"station", text, "where it was recorded", at<R, &R::station>, "", "", "empty"}}}};
  return table;
}

const TableOf<AttemptRecord>& recordingTable() {
  using R = AttemptRecord;
  static const TableOf<R> table{
      {"recording",
       {{"attempt", integerOrNull, "row of attempt"},
        {"file_name", text, "name of the recording's file, without folder", at<R, &R::fileName>},
        {"chain_head", blob, "BLAKE2b-256 head of the content chain, as seen at import", at<R, &R::chainHead>},
        {"steps", integer, "number of steps", at<R, &R::steps>},
        {"step_seconds", real, "length of a step", at<R, &R::stepSeconds>, "s", "more than 0"},
        {"complete", integer, "the recording was closed", at<R, &R::complete>, "", yesNo}}}};
  return table;
}

const TableOf<RecordingSignature>& signatureTable() {
  using R = RecordingSignature;
  static const TableOf<R> table{{"recording_signature",
                                 {{"attempt", integerOrNull, "row of attempt"},
                                  {"chain_head", blob, "head that was signed"},
                                  {"public_key", blob, "Ed25519 key of the station", at<R, &R::publicKey>},
                                  {"signature", blob, "Ed25519 signature of the head", at<R, &R::value>}}}};
  return table;
}

const TableOf<Verification>& verificationTable() {
  using R = Verification;
  static const TableOf<R> table{
      {"verification",
       {{"attempt", integerOrNull, "row of attempt"},
        {"verdict", integer, "what the newest replay said", at<R, &R::verdict>, "",
         "0 verified, 1 diverged, 2 damaged, 3 not checkable here, 4 not checked"},
        {"detail", text, "where it diverged, or what is damaged", at<R, &R::text>, "", "", "empty"},
        {"software", text, "what judged", at<R, &R::software>, "", "", "empty"},
        {"verified_utc", text, "when", {}, "", utc}}}};
  return table;
}

const TableOf<CheckpointValue>& checkpointValueTable() {
  using R = CheckpointValue;
  static const TableOf<R> table{
      {"checkpoint_value",
       {{"attempt", integer, "row of attempt"},
        {"position", integer, "place of the checkpoint in the registry's order"},
        {"name", text, "checkpoint", at<R, &R::name>},
        {"subject", text, "hand, organ or phase", at<R, &R::subject>, "", "", "empty: the attempt as a whole"},
        {"version", integer, "version of the checkpoint", at<R, &R::version>},
        {"availability", integer, "whether there is a value", at<R, &R::availability>, "", kindsOfMissing},
        {"value", realOrNull, "the value, in unit", at<R, &R::value>, "", "finite",
         "empty where availability is not 0"},
        {"reason", text, "why there is no value", at<R, &R::reason>, "", "", "empty where availability is 0"},
        {"note", text, "what a reader of the value must know", at<R, &R::note>, "", "", "empty"},
        {"unit", text, "SI unit of the value", at<R, &R::unit>},
        {"origin", integer, "what it was computed from", at<R, &R::origin>, "",
         "0 re-simulated, 1 observables, 2 samples"},
        {"filter", text, "resampling and filter when the value was made", at<R, &R::filter>},
        {"coverage", realOrNull, "share of the window that samples cover", at<R, &R::coverage>, "1", "0 to 1",
         "empty: not of samples, or not known"}}}};
  return table;
}

const TableOf<ExternalMetric>& externalMetricTable() {
  using R = ExternalMetric;
  static const TableOf<R> table{
      {"external_metric",
       {{"id", integerOrNull, "number of the row, which other tables name"},
        {"name", text, "name of the metric, as its script declares it",
         at<R, &R::definition, &CheckpointDefinition::name>},
        {"version", integer, "version of the metric", at<R, &R::definition, &CheckpointDefinition::version>},
        {"title", text, "what it is", at<R, &R::definition, &CheckpointDefinition::title>},
        {"unit", text, "unit of its values", at<R, &R::definition, &CheckpointDefinition::unit>},
        {"direction", integer, "which way is better", at<R, &R::definition, &CheckpointDefinition::direction>, "",
         "0 none, 1 lower, 2 higher"},
        {"sha256", text, "SHA-256 of the script", at<R, &R::sha256>},
        {"registered_utc", text, "when its first value came in", {}, "", utc}}}};
  return table;
}

const TableOf<CheckpointValue>& externalValueTable() {
  using R = CheckpointValue;
  static const TableOf<R> table{
      {"external_value",
       {{"attempt", integer, "row of attempt"},
        {"metric", integer, "row of external_metric"},
        {"availability", integer, "whether there is a value", at<R, &R::availability>, "", "0 value, 2 not available"},
        {"value", realOrNull, "the value, in the metric's unit", at<R, &R::value>, "", "finite",
         "empty where availability is not 0"},
        {"reason", text, "why there is no value", at<R, &R::reason>, "", "", "empty where availability is 0"},
        {"note", text, "what a reader of the value must know", at<R, &R::note>, "", "", "empty"}}}};
  return table;
}

const TableOf<ValueInterval>& valueIntervalTable() {
  using R = ValueInterval;
  static const TableOf<R> table{
      {"value_interval",
       {{"attempt", integer, "row of attempt"},
        {"name", text, "checkpoint", at<R, &R::name>},
        {"subject", text, "hand, organ or phase", at<R, &R::subject>, "", "", "empty: the attempt as a whole"},
        {"version", integer, "version of the checkpoint", at<R, &R::version>},
        {"method", integer, "how the interval was made"},
        {"value", real, "the value that the interval is of, in the checkpoint's unit", at<R, &R::value>},
        {"step_effect", real, "change of the value to steps of length zero, extrapolated", at<R, &R::stepEffect>},
        {"mesh_effect", real, "change of the value to elements of size zero, extrapolated", at<R, &R::meshEffect>},
        {"constants_spread", real, "standard deviation of the value over the assumed constants",
         at<R, &R::constantsSpread>},
        {"lower", realOrNull, "lower end of the interval", at<R, &R::lower>, "", "finite", "empty: there is none"},
        {"upper", realOrNull, "upper end of the interval", at<R, &R::upper>, "", "finite", "empty: there is none"},
        {"reason", text, "why there is no interval", at<R, &R::reason>, "", "", "empty where there is one"},
        {"runs", blob, "the value in each run with other constants, little-endian doubles", at<R, &R::runs>, "", "",
         "empty: there is no interval"}}}};
  return table;
}

const TableOf<Station>& stationTable() {
  using R = Station;
  static const TableOf<R> table{
      {"station",
       {{"name", text, "name of the station", at<R, &R::name>},
        {"site", text, "where it stands", at<R, &R::site>, "", "", "empty"},
        {"public_key", blobOrNull, "Ed25519 key that it signs with", at<R, &R::publicKey>, "", "", "empty"},
        {"note", text, "a word on it", at<R, &R::note>, "", "", "empty"}}}};
  return table;
}

const TableOf<RegisteredProtocol>& protocolTable() {
  using R = RegisteredProtocol;
  static const TableOf<R> table{{"protocol",
                                 {{"id", integerOrNull, "number of the row"},
                                  {"name", text, "name of the protocol", at<R, &R::name>},
                                  {"version", integer, "its version", at<R, &R::version>},
                                  {"sha256", text, "SHA-256 of the text", at<R, &R::sha256>},
                                  {"text", text, "the protocol, byte for byte", at<R, &R::text>},
                                  {"registered_utc", text, "when it was registered", at<R, &R::registeredUtc>, "", utc},
                                  {"registered_by", text, "by whom", at<R, &R::by>}}}};
  return table;
}

const TableOf<StoredDocument>& formTable() {
  using R = StoredDocument;
  static const TableOf<R> table{{"form",
                                 {{"id", integerOrNull, "number of the row, which other tables name"},
                                  {"name", text, "name of the form", at<R, &R::name>},
                                  {"version", integer, "its version", at<R, &R::version>},
                                  {"sha256", text, "SHA-256 of the text", at<R, &R::sha256>},
                                  {"text", text, "the form, byte for byte", at<R, &R::text>}}}};
  return table;
}

const TableOf<AnalysisLock>& analysisLockTable() {
  using R = AnalysisLock;
  static const TableOf<R> table{
      {"analysis_lock",
       {{"protocol_sha256", text, "SHA-256 of the protocol's text", at<R, &R::protocolSha256>},
        {"protocol", text, "its name and version", at<R, &R::protocol>},
        {"options", text, "choices of the study beside the protocol", at<R, &R::options>},
        {"values_sha256", text, "SHA-256 of attempts, groups and values as the study read them",
         at<R, &R::valuesSha256>},
        {"software", text, "program, and its simulation version", at<R, &R::software>},
        {"locked_utc", text, "when", at<R, &R::lockedUtc>, "", utc},
        {"locked_by", text, "by whom", at<R, &R::by>}}}};
  return table;
}

const TableOf<Norm>& normTable() {
  using R = Norm;
  static const TableOf<R> table{
      {"norm",
       {{"id", integerOrNull, "number of the row, which other tables name"},
        {"name", text, "name of the norm", at<R, &R::name>},
        {"version", integer, "its version", at<R, &R::version>},
        {"comparability_key", text, "key of its attempts", at<R, &R::comparabilityKey>},
        {"judged_by", text, "what says who is competent", at<R, &R::judgedBy>},
        {"least_passed", integer, "figures of the rule that must be passed; 0: all", at<R, &R::leastPassed>},
        {"members", integer, "attempts when it was made", at<R, &R::membersMade>},
        {"synthetic", integer, "made of performers' attempts", at<R, &R::synthetic>, "", yesNo},
        {"seed", text, "seed of the bootstrap, unsigned 64 bits in decimal", digits<R, &R::seed>},
        {"created_utc", text, "when", at<R, &R::createdUtc>, "", utc},
        {"created_by", text, "by whom", at<R, &R::by>}}}};
  return table;
}

const TableOf<NormCheckpoint>& normCheckpointTable() {
  using R = NormCheckpoint;
  static const TableOf<R> table{
      {"norm_checkpoint",
       {{"norm", integer, "row of norm"},
        {"position", integer, "place in the sheet"},
        {"checkpoint", text, "checkpoint", at<R, &R::checkpoint>},
        {"subject", text, "hand, organ or phase", at<R, &R::subject>, "", "", "empty: the attempt as a whole"},
        {"version", integer, "version of the checkpoint", at<R, &R::version>},
        {"direction", integer, "which way is better", at<R, &R::direction>, "", "1 lower, 2 higher"},
        {"log_scale", integer, "curves of the logarithms", at<R, &R::logScale>, "", yesNo},
        {"in_rule", integer, "counts for the overall judgement", at<R, &R::inRule>, "", yesNo},
        {"cut", realOrNull, "pass mark, in the checkpoint's SI unit", at<R, &R::cut>, "", "", "empty"},
        {"lower", realOrNull, "lower end of the cut's 95 % interval", at<R, &R::lower>, "", "", "empty"},
        {"upper", realOrNull, "upper end of the cut's 95 % interval", at<R, &R::upper>, "", "", "empty"},
        {"reason", text, "why there is no cut, or no interval", at<R, &R::reason>, "", "", "empty"}}}};
  return table;
}

const TableOf<NormEvidence>& normEvidenceTable() {
  using R = NormEvidence;
  static const TableOf<R> table{{"norm_evidence",
                                 {{"id", integerOrNull, "number of the row"},
                                  {"norm", integer, "row of norm"},
                                  {"statement", text, "what the site puts forward", at<R, &R::statement>},
                                  {"file_name", text, "document, without folder", at<R, &R::fileName>},
                                  {"sha256", text, "SHA-256 of the document", at<R, &R::sha256>},
                                  {"attached_by", text, "by whom", at<R, &R::by>},
                                  {"attached_utc", text, "when", at<R, &R::attachedUtc>, "", utc}}}};
  return table;
}

const std::vector<const DeclaredTable*>& cohortTables() {
  static const std::vector<const DeclaredTable*> tables = [] {
    std::vector<const DeclaredTable*> all{&participantTable(),    &attemptTable(),       &recordingTable(),
                                          &signatureTable(),      &verificationTable(),  &checkpointValueTable(),
                                          &externalMetricTable(), &externalValueTable(), &valueIntervalTable(),
                                          &stationTable(),        &protocolTable(),      &formTable(),
                                          &analysisLockTable(),   &normTable(),          &normCheckpointTable(),
                                          &normEvidenceTable()};
    for (const DeclaredTable& table : furtherTables()) all.push_back(&table);
    return all;
  }();
  return tables;
}

const DeclaredColumn* findColumn(std::string_view table, std::string_view column) {
  for (const DeclaredTable* t : cohortTables()) {
    if (t->name != table) continue;
    for (const DeclaredColumn& c : t->columns) {
      if (c.name == column) return &c;
    }
  }
  return nullptr;
}

}  // namespace calot::analytics
