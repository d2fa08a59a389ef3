-- SPDX-License-Identifier: GPL-3.0-or-later
-- Fixed tables: where and by whom it was recorded, who withdrew, what was handed out, and by which key it was signed.
-- docs/reference/cohort.md explains them; docs/explanation/threat-model.md says what a signature shows.

ALTER TABLE attempt ADD COLUMN station TEXT NOT NULL DEFAULT '';

CREATE TABLE site (
  name TEXT PRIMARY KEY CHECK (name <> ''),
  note TEXT NOT NULL DEFAULT ''
) STRICT, WITHOUT ROWID;

CREATE TABLE arm (
  name TEXT PRIMARY KEY CHECK (name <> ''),
  note TEXT NOT NULL DEFAULT ''
) STRICT, WITHOUT ROWID;

-- A station that is known by name; with the public key that it signs with, if that was registered.
CREATE TABLE station (
  name TEXT PRIMARY KEY CHECK (name <> ''),
  site TEXT NOT NULL DEFAULT '',
  public_key BLOB CHECK (public_key IS NULL OR length(public_key) = 32), -- Ed25519
  note TEXT NOT NULL DEFAULT ''
) STRICT, WITHOUT ROWID;

-- Participants under a name, to be studied or shown together.
CREATE TABLE cohort (
  name TEXT PRIMARY KEY CHECK (name <> ''),
  note TEXT NOT NULL DEFAULT ''
) STRICT, WITHOUT ROWID;
CREATE TABLE cohort_participant (
  cohort TEXT NOT NULL REFERENCES cohort (name) ON DELETE CASCADE,
  participant INTEGER NOT NULL REFERENCES participant (id) ON DELETE CASCADE,
  PRIMARY KEY (cohort, participant)
) STRICT, WITHOUT ROWID;

-- Whatever a participant is given becomes known, so that lists are whole.
CREATE TRIGGER participant_is_added AFTER INSERT ON participant BEGIN
  INSERT INTO site (name) SELECT NEW.site WHERE NEW.site <> '' ON CONFLICT DO NOTHING;
  INSERT INTO arm (name) SELECT NEW.arm WHERE NEW.arm <> '' ON CONFLICT DO NOTHING;
END;
CREATE TRIGGER participant_moves AFTER UPDATE OF site, arm ON participant BEGIN
  INSERT INTO site (name) SELECT NEW.site WHERE NEW.site <> '' ON CONFLICT DO NOTHING;
  INSERT INTO arm (name) SELECT NEW.arm WHERE NEW.arm <> '' ON CONFLICT DO NOTHING;
END;
CREATE TRIGGER attempt_names_station AFTER INSERT ON attempt BEGIN
  INSERT INTO station (name) SELECT NEW.station WHERE NEW.station <> '' ON CONFLICT DO NOTHING;
END;
CREATE TRIGGER attempt_gets_station AFTER UPDATE OF station ON attempt BEGIN
  INSERT INTO station (name) SELECT NEW.station WHERE NEW.station <> '' ON CONFLICT DO NOTHING;
END;
INSERT INTO site (name) SELECT DISTINCT site FROM participant WHERE site <> '';
INSERT INTO arm (name) SELECT DISTINCT arm FROM participant WHERE arm <> '';

-- The signature that a recording came in with, over the chain head that stands here: valid when it was imported.
CREATE TABLE recording_signature (
  attempt INTEGER PRIMARY KEY REFERENCES attempt (id) ON DELETE CASCADE,
  chain_head BLOB NOT NULL CHECK (length(chain_head) = 32),
  public_key BLOB NOT NULL CHECK (length(public_key) = 32),
  signature BLOB NOT NULL CHECK (length(signature) = 64)
) STRICT;

-- What was written from this database for others to have, and of which attempts.
CREATE TABLE export (
  id INTEGER PRIMARY KEY,
  at_utc TEXT NOT NULL,
  kind TEXT NOT NULL CHECK (kind <> ''), -- study-csv, study-html, recording-csv, film, ...
  target TEXT NOT NULL -- file or folder
) STRICT;
CREATE TABLE export_attempt (
  export INTEGER NOT NULL REFERENCES export (id) ON DELETE CASCADE,
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  PRIMARY KEY (export, attempt)
) STRICT, WITHOUT ROWID;

-- Participants who stay but take no part in research any more.
CREATE TABLE research_withdrawal (
  participant INTEGER PRIMARY KEY REFERENCES participant (id) ON DELETE CASCADE,
  withdrawn_utc TEXT NOT NULL
) STRICT;

-- What is left of what was withdrawn: that it was, when, and how much. No name, no uuid.
CREATE TABLE tombstone (
  id TEXT PRIMARY KEY CHECK (length(id) = 36), -- random
  withdrawn_utc TEXT NOT NULL,
  scope TEXT NOT NULL CHECK (scope IN ('research', 'all')),
  attempts INTEGER NOT NULL CHECK (attempts >= 0)
) STRICT, WITHOUT ROWID;
-- BLAKE2b-256 of an attempt's uuid, whose 122 random bits no one can guess: enough to refuse it when it comes again.
CREATE TABLE tombstone_attempt (
  digest BLOB PRIMARY KEY CHECK (length(digest) = 32),
  tombstone TEXT NOT NULL REFERENCES tombstone (id)
) STRICT, WITHOUT ROWID;

-- An audit row's words may go where they name what was withdrawn; the row, its time and its action stay.
DROP TRIGGER audit_keeps_words;
CREATE TRIGGER audit_keeps_words BEFORE UPDATE ON audit
WHEN NOT (NEW.id = OLD.id AND NEW.at_utc = OLD.at_utc AND NEW.action = OLD.action AND NEW.detail = ''
          AND EXISTS (SELECT 1 FROM tombstone WHERE 'withdrawn ' || id = NEW.subject))
BEGIN SELECT RAISE(ABORT, 'audit rows are kept'); END;
