// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/tables.h"

#include "analytics/cohort/column_members.h"

namespace calot::analytics {

namespace {

constexpr const char *sqlText = "TEXT NOT NULL", *sqlInteger = "INTEGER NOT NULL", *sqlReal = "REAL NOT NULL",
                     *sqlBlob = "BLOB NOT NULL";
constexpr const char *integerOrNull = "INTEGER", *realOrNull = "REAL", *blobOrNull = "BLOB";
constexpr const char *utc = "ISO 8601 UTC with Z", *yesNo = "0 no, 1 yes";
constexpr const char* kindsOfMissing =
    "0 value, 1 not applicable, 2 not available, 3 absent hand, 4 too little coverage";

/// Tables that no struct holds.
const std::vector<DeclaredTable> furtherTables{
    {"participant_experience",
     {{"participant", sqlInteger, "row of participant"},
      {"criterion", sqlText, "what was asked, as laparoscopies"},
      {"value", sqlText, "the answer"}}},
    {"consent",
     {{"participant", sqlInteger, "row of participant"},
      {"purpose", sqlText, "what for, as research"},
      {"given_on", sqlText, "day of consent", {}, "", "YYYY-MM-DD"}}},
    {"exclusion",
     {{"attempt", integerOrNull, "row of attempt"},
      {"reason", sqlText, "why it stays out of studies"},
      {"excluded_by", sqlText, "by whose word"},
      {"excluded_utc", sqlText, "when", {}, "", utc}}},
    {"attempt_tag", {{"attempt", sqlInteger, "row of attempt"}, {"tag", sqlText, "word that people find it by"}}},
    {"audit",
     {{"id", integerOrNull, "number of the row"},
      {"at_utc", sqlText, "when", {}, "", utc},
      {"action", sqlText, "what was done, as attempt-import"},
      {"subject", sqlText, "pseudonym, uuid or name that it was done to"},
      {"detail", sqlText, "what exactly", {}, "", "", "empty"}}},
    {"site", {{"name", sqlText, "name of the site"}, {"note", sqlText, "a word on it", {}, "", "", "empty"}}},
    {"arm", {{"name", sqlText, "name of the study arm"}, {"note", sqlText, "a word on it", {}, "", "", "empty"}}},
    {"cohort", {{"name", sqlText, "name of the cohort"}, {"note", sqlText, "a word on it", {}, "", "", "empty"}}},
    {"cohort_participant",
     {{"cohort", sqlText, "name of the cohort"}, {"participant", sqlInteger, "row of participant"}}},
    {"export",
     {{"id", integerOrNull, "number of the row"},
      {"at_utc", sqlText, "when", {}, "", utc},
      {"kind", sqlText, "what was written, as study-csv"},
      {"target", sqlText, "file or folder"}}},
    {"export_attempt", {{"export", sqlInteger, "row of export"}, {"attempt", sqlInteger, "row of attempt"}}},
    {"research_withdrawal",
     {{"participant", integerOrNull, "row of participant"}, {"withdrawn_utc", sqlText, "when", {}, "", utc}}},
    {"tombstone",
     {{"id", sqlText, "random number of the withdrawal"},
      {"withdrawn_utc", sqlText, "when", {}, "", utc},
      {"scope", sqlText, "what went", {}, "", "research, all"},
      {"attempts", sqlInteger, "how many attempts went"}}},
    {"tombstone_attempt",
     {{"digest", sqlBlob, "BLAKE2b-256 of the uuid of an attempt that was withdrawn"},
      {"tombstone", sqlText, "id of tombstone"}}},
    {"rating",
     {{"form", sqlInteger, "row of form"},
      {"attempt", sqlInteger, "row of attempt"},
      {"rater", sqlText, "pseudonym of the rater"},
      {"item", sqlText, "key of the item"},
      {"score", sqlInteger, "score", {}, "", "whole numbers of the form's scale", "an item left blank has no row"},
      {"rated_utc", sqlText, "when", {}, "", utc}}},
    {"questionnaire",
     {{"form", sqlInteger, "row of form"},
      {"participant", sqlInteger, "row of participant"},
      {"item", sqlText, "key of the item"},
      {"score", sqlInteger, "score", {}, "", "whole numbers of the form's scale", "an item left blank has no row"},
      {"rated_utc", sqlText, "when", {}, "", utc}}},
    {"rating_pack",
     {{"id", sqlText, "random name of the pack"},
      {"form", sqlText, "name of the form in it"},
      {"form_version", sqlInteger, "its version"},
      {"form_sha256", sqlText, "SHA-256 of its text"},
      {"form_text", sqlText, "the form, byte for byte"},
      {"packed_utc", sqlText, "when", {}, "", utc}}},
    {"rater",
     {{"name", sqlText, "pseudonym, as in rating"},
      {"criterion", sqlText, "what is described, as experience"},
      {"value", sqlText, "the answer"}}},
    {"rating_pack_rater",
     {{"pack", sqlText, "name of the pack"},
      {"rater", sqlText, "pseudonym of the rater"},
      {"seal_key", sqlBlob, "random key with which the rater's page seals the answers"},
      {"taken_utc", sqlText, "when the answers were stored", {}, "", utc, "empty: not yet"}}},
    {"rating_pack_film",
     {{"pack", sqlText, "name of the pack"},
      {"rater", sqlText, "pseudonym of the rater"},
      {"name", sqlText, "random name of the film"},
      {"position", sqlInteger, "place in the order in which the rater sees the films, from 0"},
      {"attempt", sqlInteger, "row of attempt"}}},
    {"group_mask",
     {{"protocol_sha256", sqlText, "SHA-256 of the protocol's text"},
      {"swapped", sqlInteger, "the protocol's second population is group 1", {}, "", yesNo},
      {"drawn_utc", sqlText, "when", {}, "", utc}}},
    {"norm_member",
     {{"norm", sqlInteger, "row of norm"},
      {"attempt", sqlInteger, "row of attempt"},
      {"competent", sqlInteger, "judged competent", {}, "", yesNo}}},
    {"norm_value",
     {{"norm", sqlInteger, "row of norm"},
      {"attempt", sqlInteger, "row of attempt"},
      {"checkpoint", sqlText, "checkpoint"},
      {"subject", sqlText, "hand, organ or phase", {}, "", "", "empty: the attempt as a whole"},
      {"value", sqlReal, "value when the norm was made, in the checkpoint's SI unit"}}}};

}  // namespace

// name, type, meaning, member, unit, allowed values, what stands where there is none
const TableOf<Participant> participantTable{
    {"participant",
     {{"id", integerOrNull, "number of the row, which other tables name"},
      {"pseudonym", sqlText, "pseudonym", at<&Participant::pseudonym>, "", "", "", "participant"},
      {"study_group", sqlText, "study group", at<&Participant::group>, "", "", "empty", "group"},
      {"arm", sqlText, "study arm", at<&Participant::arm>, "", "", "empty"},
      {"site", sqlText, "where the participant belongs", at<&Participant::site>, "", "", "empty"},
      {"created_utc", sqlText, "when the row was made", {}, "", utc}}}};

const TableOf<AttemptRecord> attemptTable{
    {"attempt",
     {{"id", integerOrNull, "number of the row, which other tables name"},
      {"uuid", sqlText, "identity of the attempt", at<&AttemptRecord::uuid>, "", "", "", "attempt"},
      {"parent_uuid", sqlText, "attempt that it branches from", at<&AttemptRecord::parent>, "", "", "empty", "parent"},
      {"participant", integerOrNull, "row of participant", {}, "", "", "empty"},
      {"scene", sqlText, "scene, or declared task of imported motion", at<&AttemptRecord::scene>},
      {"scene_major", sqlInteger, "version of the scene that comparison asks for", at<&AttemptRecord::sceneMajor>},
      {"scene_minor", sqlInteger, "version of the scene within it", at<&AttemptRecord::sceneMinor>},
      {"operator_kind", sqlInteger, "who acted", at<&AttemptRecord::operatorKind>, "",
       "0 human, 1 kinematics, 2 performer", "", "operator"},
      {"profile", sqlText, "profile of a performer", at<&AttemptRecord::profile>, "", "", "empty"},
      {"profile_version", sqlText, "version of the profile", at<&AttemptRecord::profileVersion>, "", "", "empty"},
      {"mode", sqlInteger, "mode", at<&AttemptRecord::mode>, "", "0 practice, 1 assessment"},
      {"purpose", sqlText, "what it was for, as training", at<&AttemptRecord::purpose>, "", "", "empty"},
      {"outcome", sqlInteger, "how it ended", at<&AttemptRecord::outcome>, "",
       "0 running, 1 completed, 2 time limit, 3 abandoned, 4 stopped, 5 technical failure"},
      {"start_utc", sqlText, "when it began", at<&AttemptRecord::startUtc>, "", utc, "empty"},
      {"seed", sqlText, "seed of the simulation, unsigned 64 bits in decimal", digits<&AttemptRecord::seed>},
      {"device", sqlText, "class of device", at<&AttemptRecord::device>, "", "", "empty"},
      {"calibration", sqlText, "calibration of the device", at<&AttemptRecord::calibration>, "", "", "empty"},
      {"simulation_version", sqlInteger, "version of the simulation; 0: motion without a scene",
       at<&AttemptRecord::simulationVersion>},
      {"comparability_key", sqlText, "attempts are compared within one key only", at<&AttemptRecord::comparabilityKey>,
       "", "", "", "key"},
      {"synthetic", sqlInteger, "made by a performer", at<&AttemptRecord::synthetic>, "", yesNo},
      {"imported_utc", sqlText, "when it first came in", {}, "", utc},
      {"station", sqlText, "where it was recorded", at<&AttemptRecord::station>, "", "", "empty"}}}};

const TableOf<AttemptRecord> recordingTable{
    {"recording",
     {{"attempt", integerOrNull, "row of attempt"},
      {"file_name", sqlText, "name of the recording's file, without folder", at<&AttemptRecord::fileName>, "", "", "",
       "file"},
      {"chain_head", sqlBlob, "BLAKE2b-256 head of the content chain, as seen at import",
       at<&AttemptRecord::chainHead>},
      {"steps", sqlInteger, "number of steps", at<&AttemptRecord::steps>},
      {"step_seconds", sqlReal, "length of a step", at<&AttemptRecord::stepSeconds>, "s", "more than 0"},
      {"complete", sqlInteger, "the recording was closed", at<&AttemptRecord::complete>, "", yesNo}}}};

const TableOf<RecordingSignature> signatureTable{
    {"recording_signature",
     {{"attempt", integerOrNull, "row of attempt"},
      {"chain_head", sqlBlob, "head that was signed"},
      {"public_key", sqlBlob, "Ed25519 key of the station", at<&RecordingSignature::publicKey>},
      {"signature", sqlBlob, "Ed25519 signature of the head", at<&RecordingSignature::value>}}}};

const TableOf<Verification> verificationTable{
    {"verification",
     {{"attempt", integerOrNull, "row of attempt"},
      {"verdict", sqlInteger, "what the newest replay said", at<&Verification::verdict>, "",
       "0 verified, 1 diverged, 2 damaged, 3 not checkable here, 4 not checked"},
      {"detail", sqlText, "where it diverged, or what is damaged", at<&Verification::text>, "", "", "empty",
       "verdict_detail"},
      {"software", sqlText, "what judged", at<&Verification::software>, "", "", "empty", "verdict_software"},
      {"verified_utc", sqlText, "when", {}, "", utc}}}};

const TableOf<CheckpointValue> checkpointValueTable{
    {"checkpoint_value",
     {{"attempt", sqlInteger, "row of attempt"},
      {"position", sqlInteger, "place of the checkpoint in the registry's order"},
      {"name", sqlText, "checkpoint", at<&CheckpointValue::name>},
      {"subject", sqlText, "hand, organ or phase", at<&CheckpointValue::subject>, "", "",
       "empty: the attempt as a whole"},
      {"version", sqlInteger, "version of the checkpoint", at<&CheckpointValue::version>},
      {"availability", sqlInteger, "whether there is a value", at<&CheckpointValue::availability>, "", kindsOfMissing},
      {"value", realOrNull, "the value, in unit", at<&CheckpointValue::value>, "", "finite",
       "empty where availability is not 0"},
      {"reason", sqlText, "why there is no value", at<&CheckpointValue::reason>, "", "",
       "empty where availability is 0"},
      {"note", sqlText, "what a reader of the value must know", at<&CheckpointValue::note>, "", "", "empty"},
      {"unit", sqlText, "SI unit of the value", at<&CheckpointValue::unit>},
      {"origin", sqlInteger, "what it was computed from", at<&CheckpointValue::origin>, "",
       "0 re-simulated, 1 observables, 2 samples"},
      {"filter", sqlText, "resampling and filter when the value was made", at<&CheckpointValue::filter>},
      {"coverage", realOrNull, "share of the window that samples cover", at<&CheckpointValue::coverage>, "1", "0 to 1",
       "empty: not of samples, or not known"},
      {"rate", realOrNull, "rate of the tracker's samples, of both hands the lower", at<&CheckpointValue::rate>, "Hz",
       "more than 0", "empty: not of samples, or not known"},
      {"noise", realOrNull, "standard deviation of the tracker's positions on each axis, of both hands the greater",
       at<&CheckpointValue::noise>, "m", "at least 0", "empty: not of samples, or not known"}}}};

const TableOf<ExternalMetric> externalMetricTable{
    {"external_metric",
     {{"id", integerOrNull, "number of the row, which other tables name"},
      {"name", sqlText, "name of the metric, as its script declares it",
       at<&ExternalMetric::definition, &CheckpointDefinition::name>},
      {"version", sqlInteger, "version of the metric", at<&ExternalMetric::definition, &CheckpointDefinition::version>},
      {"title", sqlText, "what it is", at<&ExternalMetric::definition, &CheckpointDefinition::title>},
      {"unit", sqlText, "unit of its values", at<&ExternalMetric::definition, &CheckpointDefinition::unit>},
      {"direction", sqlInteger, "which way is better",
       at<&ExternalMetric::definition, &CheckpointDefinition::direction>, "", "0 none, 1 lower, 2 higher"},
      {"sha256", sqlText, "SHA-256 of the script", at<&ExternalMetric::sha256>},
      {"registered_utc", sqlText, "when its first value came in", {}, "", utc}}}};

const TableOf<CheckpointValue> externalValueTable{
    {"external_value",
     {{"attempt", sqlInteger, "row of attempt"},
      {"metric", sqlInteger, "row of external_metric"},
      {"availability", sqlInteger, "whether there is a value", at<&CheckpointValue::availability>, "",
       "0 value, 2 not available"},
      {"value", realOrNull, "the value, in the metric's unit", at<&CheckpointValue::value>, "", "finite",
       "empty where availability is not 0"},
      {"reason", sqlText, "why there is no value", at<&CheckpointValue::reason>, "", "",
       "empty where availability is 0"},
      {"note", sqlText, "what a reader of the value must know", at<&CheckpointValue::note>, "", "", "empty"}}}};

const TableOf<ValueInterval> valueIntervalTable{
    {"value_interval",
     {{"attempt", sqlInteger, "row of attempt"},
      {"name", sqlText, "checkpoint", at<&ValueInterval::name>},
      {"subject", sqlText, "hand, organ or phase", at<&ValueInterval::subject>, "", "",
       "empty: the attempt as a whole"},
      {"version", sqlInteger, "version of the checkpoint", at<&ValueInterval::version>},
      {"method", sqlInteger, "how the interval was made"},
      {"value", sqlReal, "the value that the interval is of, in the checkpoint's unit", at<&ValueInterval::value>},
      {"step_effect", sqlReal, "change of the value to steps of length zero, extrapolated",
       at<&ValueInterval::stepEffect>},
      {"mesh_effect", sqlReal, "change of the value to elements of size zero, extrapolated",
       at<&ValueInterval::meshEffect>},
      {"constants_spread", sqlReal, "standard deviation of the value over the assumed constants",
       at<&ValueInterval::constantsSpread>},
      {"lower", realOrNull, "lower end of the interval", at<&ValueInterval::lower>, "", "finite",
       "empty: there is none"},
      {"upper", realOrNull, "upper end of the interval", at<&ValueInterval::upper>, "", "finite",
       "empty: there is none"},
      {"reason", sqlText, "why there is no interval", at<&ValueInterval::reason>, "", "", "empty where there is one"},
      {"runs", sqlBlob, "the value in each run with other constants, little-endian doubles", at<&ValueInterval::runs>,
       "", "", "empty: there is no interval"}}}};

const TableOf<Station> stationTable{
    {"station",
     {{"name", sqlText, "name of the station", at<&Station::name>},
      {"site", sqlText, "where it stands", at<&Station::site>, "", "", "empty"},
      {"public_key", blobOrNull, "Ed25519 key that it signs with", at<&Station::publicKey>, "", "", "empty"},
      {"note", sqlText, "a word on it", at<&Station::note>, "", "", "empty"}}}};

const TableOf<RegisteredProtocol> protocolTable{
    {"protocol",
     {{"id", integerOrNull, "number of the row"},
      {"name", sqlText, "name of the protocol", inRow<RegisteredProtocol, &RegisteredProtocol::name>},
      {"version", sqlInteger, "its version", inRow<RegisteredProtocol, &RegisteredProtocol::version>},
      {"sha256", sqlText, "SHA-256 of the text", inRow<RegisteredProtocol, &RegisteredProtocol::sha256>},
      {"text", sqlText, "the protocol, byte for byte", inRow<RegisteredProtocol, &RegisteredProtocol::text>},
      {"registered_utc", sqlText, "when it was registered",
       inRow<RegisteredProtocol, &RegisteredProtocol::registeredUtc>, "", utc},
      {"registered_by", sqlText, "by whom", inRow<RegisteredProtocol, &RegisteredProtocol::by>},
      {"withdrawn_utc", sqlText, "when it was withdrawn without data",
       inRow<RegisteredProtocol, &RegisteredProtocol::withdrawnUtc>, "", utc, "empty: it stands"}}}};

const TableOf<StoredDocument> formTable{{"form",
                                         {{"id", integerOrNull, "number of the row, which other tables name"},
                                          {"name", sqlText, "name of the form", at<&StoredDocument::name>},
                                          {"version", sqlInteger, "its version", at<&StoredDocument::version>},
                                          {"sha256", sqlText, "SHA-256 of the text", at<&StoredDocument::sha256>},
                                          {"text", sqlText, "the form, byte for byte", at<&StoredDocument::text>}}}};

const TableOf<AnalysisLock> analysisLockTable{
    {"analysis_lock",
     {{"protocol_sha256", sqlText, "SHA-256 of the protocol's text", at<&AnalysisLock::protocolSha256>},
      {"protocol", sqlText, "its name and version", at<&AnalysisLock::protocol>},
      {"options", sqlText, "choices of the study beside the protocol", at<&AnalysisLock::options>},
      {"values_sha256", sqlText, "SHA-256 of attempts, groups and values as the study read them",
       at<&AnalysisLock::valuesSha256>},
      {"software", sqlText, "program, and its simulation version", at<&AnalysisLock::software>},
      {"locked_utc", sqlText, "when", at<&AnalysisLock::lockedUtc>, "", utc},
      {"locked_by", sqlText, "by whom", at<&AnalysisLock::by>}}}};

const TableOf<Norm> normTable{
    {"norm",
     {{"id", integerOrNull, "number of the row, which other tables name"},
      {"name", sqlText, "name of the norm", at<&Norm::name>},
      {"version", sqlInteger, "its version", at<&Norm::version>},
      {"comparability_key", sqlText, "key of its attempts", at<&Norm::comparabilityKey>},
      {"judged_by", sqlText, "what says who is competent", at<&Norm::judgedBy>},
      {"least_passed", sqlInteger, "figures of the rule that must be passed; 0: all", at<&Norm::leastPassed>},
      {"members", sqlInteger, "attempts when it was made", at<&Norm::membersMade>},
      {"synthetic", sqlInteger, "made of performers' attempts", at<&Norm::synthetic>, "", yesNo},
      {"seed", sqlText, "seed of the bootstrap, unsigned 64 bits in decimal", digits<&Norm::seed>},
      {"created_utc", sqlText, "when", at<&Norm::createdUtc>, "", utc},
      {"created_by", sqlText, "by whom", at<&Norm::by>}}}};

const TableOf<NormCheckpoint> normCheckpointTable{
    {"norm_checkpoint",
     {{"norm", sqlInteger, "row of norm"},
      {"position", sqlInteger, "place in the sheet"},
      {"checkpoint", sqlText, "checkpoint", at<&NormCheckpoint::checkpoint>},
      {"subject", sqlText, "hand, organ or phase", at<&NormCheckpoint::subject>, "", "",
       "empty: the attempt as a whole"},
      {"version", sqlInteger, "version of the checkpoint", at<&NormCheckpoint::version>},
      {"direction", sqlInteger, "which way is better", at<&NormCheckpoint::direction>, "", "1 lower, 2 higher"},
      {"log_scale", sqlInteger, "curves of the logarithms", at<&NormCheckpoint::logScale>, "", yesNo},
      {"in_rule", sqlInteger, "counts for the overall judgement", at<&NormCheckpoint::inRule>, "", yesNo},
      {"cut", realOrNull, "pass mark, in the checkpoint's SI unit", at<&NormCheckpoint::cut>, "", "", "empty"},
      {"lower", realOrNull, "lower end of the cut's 95 % interval", at<&NormCheckpoint::lower>, "", "", "empty"},
      {"upper", realOrNull, "upper end of the cut's 95 % interval", at<&NormCheckpoint::upper>, "", "", "empty"},
      {"reason", sqlText, "why there is no cut, or no interval", at<&NormCheckpoint::reason>, "", "", "empty"}}}};

const TableOf<NormEvidence> normEvidenceTable{
    {"norm_evidence",
     {{"id", integerOrNull, "number of the row"},
      {"norm", sqlInteger, "row of norm"},
      {"statement", sqlText, "what the site puts forward", at<&NormEvidence::statement>},
      {"file_name", sqlText, "document, without folder", at<&NormEvidence::fileName>},
      {"sha256", sqlText, "SHA-256 of the document", at<&NormEvidence::sha256>},
      {"attached_by", sqlText, "by whom", at<&NormEvidence::by>},
      {"attached_utc", sqlText, "when", at<&NormEvidence::attachedUtc>, "", utc}}}};

const std::vector<const DeclaredTable*>& cohortTables() {
  static const std::vector<const DeclaredTable*> tables = [] {
    std::vector<const DeclaredTable*> all{
        &participantTable,     &attemptTable,        &recordingTable,     &signatureTable,     &verificationTable,
        &checkpointValueTable, &externalMetricTable, &externalValueTable, &valueIntervalTable, &stationTable,
        &protocolTable,        &formTable,           &analysisLockTable,  &normTable,          &normCheckpointTable,
        &normEvidenceTable};
    for (const DeclaredTable& table : furtherTables) all.push_back(&table);
    return all;
  }();
  return tables;
}

const std::vector<DeclaredTable>& cohortViews() {
  static const std::vector<DeclaredTable> views = [] {
    const auto view = [](const char* name, const std::vector<std::pair<const char*, const char*>>& columns) {
      DeclaredTable declared{name, {{"attempt", sqlText, "uuid of the attempt"}}};
      for (const auto& [table, column] : columns) {
        DeclaredColumn& c = declared.columns.emplace_back(*findColumn(table, column));
        c.member = {};
        if (std::string_view(column) == "pseudonym") c.name = "participant";
      }
      declared.columns.push_back(
          {"trial", sqlInteger, "number of the attempt among the participant's of one comparability key, by start"});
      return declared;
    };
    std::vector<DeclaredTable> all{view("analysis_attempt", {{"participant", "pseudonym"},
                                                             {"participant", "study_group"},
                                                             {"participant", "arm"},
                                                             {"participant", "site"},
                                                             {"attempt", "scene"},
                                                             {"attempt", "comparability_key"},
                                                             {"attempt", "outcome"},
                                                             {"attempt", "start_utc"}}),
                                   view("analysis_value", {{"participant", "pseudonym"},
                                                           {"participant", "study_group"},
                                                           {"participant", "arm"},
                                                           {"participant", "site"},
                                                           {"attempt", "comparability_key"},
                                                           {"attempt", "outcome"},
                                                           {"checkpoint_value", "name"},
                                                           {"checkpoint_value", "subject"},
                                                           {"checkpoint_value", "version"},
                                                           {"checkpoint_value", "value"},
                                                           {"checkpoint_value", "unit"},
                                                           {"checkpoint_value", "availability"},
                                                           {"checkpoint_value", "reason"},
                                                           {"checkpoint_value", "origin"}})};
    all.back().columns.push_back(
        {"of_phase", sqlInteger, "of a single phase, other than how long it lasted", {}, "", yesNo});
    return all;
  }();
  return views;
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
