-- SPDX-License-Identifier: GPL-3.0-or-later
-- Fixed tables: what no recording can give back. docs/reference/cohort.md explains them. Times are ISO 8601 UTC with Z.
-- Numbers of enumerations are those of the recording (schemas/recording.md) and never reused.

CREATE TABLE participant (
  id INTEGER PRIMARY KEY,
  pseudonym TEXT NOT NULL UNIQUE CHECK (length(pseudonym) BETWEEN 1 AND 64),
  study_group TEXT NOT NULL DEFAULT '',
  arm TEXT NOT NULL DEFAULT '',
  site TEXT NOT NULL DEFAULT '',
  created_utc TEXT NOT NULL
) STRICT;

-- Experience as recorded criteria: laparoscopies = 240, level = attending.
CREATE TABLE participant_experience (
  participant INTEGER NOT NULL REFERENCES participant (id) ON DELETE CASCADE,
  criterion TEXT NOT NULL CHECK (criterion <> ''),
  value TEXT NOT NULL,
  PRIMARY KEY (participant, criterion)
) STRICT, WITHOUT ROWID;

CREATE TABLE consent (
  participant INTEGER NOT NULL REFERENCES participant (id) ON DELETE CASCADE,
  purpose TEXT NOT NULL CHECK (purpose <> ''),
  given_on TEXT NOT NULL CHECK (given_on GLOB '[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]'),
  PRIMARY KEY (participant, purpose)
) STRICT, WITHOUT ROWID;

-- One run of one operator. A branch names the attempt it leaves; that one need not be in this database.
CREATE TABLE attempt (
  id INTEGER PRIMARY KEY,
  uuid TEXT NOT NULL UNIQUE CHECK (length(uuid) = 36),
  parent_uuid TEXT NOT NULL DEFAULT '',
  participant INTEGER REFERENCES participant (id),
  scene TEXT NOT NULL,
  scene_major INTEGER NOT NULL,
  scene_minor INTEGER NOT NULL,
  operator_kind INTEGER NOT NULL CHECK (operator_kind BETWEEN 0 AND 2), -- human, kinematics, performer
  profile TEXT NOT NULL DEFAULT '',
  profile_version TEXT NOT NULL DEFAULT '',
  mode INTEGER NOT NULL CHECK (mode BETWEEN 0 AND 1), -- practice, assessment
  purpose TEXT NOT NULL DEFAULT '',
  outcome INTEGER NOT NULL CHECK (outcome BETWEEN 0 AND 5), -- running, completed, time limit, abandoned, stopped, technical failure
  start_utc TEXT NOT NULL,
  seed TEXT NOT NULL, -- unsigned 64 bits in decimal: SQLite's integers are signed
  device TEXT NOT NULL DEFAULT '',
  calibration TEXT NOT NULL DEFAULT '',
  simulation_version INTEGER NOT NULL,
  comparability_key TEXT NOT NULL,
  synthetic INTEGER NOT NULL CHECK (synthetic IN (0, 1)),
  imported_utc TEXT NOT NULL
) STRICT;
CREATE INDEX attempt_by_participant ON attempt (participant);
CREATE INDEX attempt_by_start ON attempt (start_utc, uuid);

-- Which attempts stay out of studies, why, and by whose word.
CREATE TABLE exclusion (
  attempt INTEGER PRIMARY KEY REFERENCES attempt (id) ON DELETE CASCADE,
  reason TEXT NOT NULL CHECK (reason <> ''),
  excluded_by TEXT NOT NULL CHECK (excluded_by <> ''),
  excluded_utc TEXT NOT NULL
) STRICT;

-- A recording's identity is its attempt and the head of its content chain, not the bytes of its file.
CREATE TABLE recording (
  attempt INTEGER PRIMARY KEY REFERENCES attempt (id) ON DELETE CASCADE,
  file_name TEXT NOT NULL, -- without folder
  chain_head BLOB NOT NULL CHECK (length(chain_head) = 32), -- BLAKE2b-256 as seen at import
  steps INTEGER NOT NULL CHECK (steps >= 0),
  step_seconds REAL NOT NULL CHECK (step_seconds > 0),
  complete INTEGER NOT NULL CHECK (complete IN (0, 1))
) STRICT;

-- Who changed what, in order; rows are only ever added.
CREATE TABLE audit (
  id INTEGER PRIMARY KEY,
  at_utc TEXT NOT NULL,
  action TEXT NOT NULL,  -- participant-add, participant-set, attempt-import, attempt-extend, attempt-exclude, ...
  subject TEXT NOT NULL, -- pseudonym or uuid
  detail TEXT NOT NULL DEFAULT ''
) STRICT;
CREATE TRIGGER audit_keeps_rows BEFORE DELETE ON audit BEGIN SELECT RAISE(ABORT, 'audit rows are kept'); END;
CREATE TRIGGER audit_keeps_words BEFORE UPDATE ON audit BEGIN SELECT RAISE(ABORT, 'audit rows are kept'); END;
