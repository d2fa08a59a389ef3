-- SPDX-License-Identifier: GPL-3.0-or-later
-- Fixed tables of blinding: what raters are given under other names, whose groups are masked, and which analysis was locked.

-- Films and a form that were packed for raters. The key, random name to attempt, stands here alone.
CREATE TABLE rating_pack (
  id TEXT PRIMARY KEY CHECK (length(id) = 36), -- random; stands in the pack
  form TEXT NOT NULL CHECK (form <> ''),
  form_version INTEGER NOT NULL CHECK (form_version >= 1),
  form_sha256 TEXT NOT NULL CHECK (length(form_sha256) = 64), -- of the form's text
  form_text TEXT NOT NULL,
  packed_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;
CREATE TABLE rating_pack_rater (
  pack TEXT NOT NULL REFERENCES rating_pack (id) ON DELETE CASCADE,
  rater TEXT NOT NULL CHECK (length(rater) BETWEEN 1 AND 64), -- pseudonym
  seal_key BLOB NOT NULL CHECK (length(seal_key) = 32), -- random; the rater's page seals the answers with it
  taken_utc TEXT NOT NULL DEFAULT '', -- when the answers were stored; empty: not yet
  PRIMARY KEY (pack, rater)
) STRICT, WITHOUT ROWID;
CREATE TABLE rating_pack_film (
  pack TEXT NOT NULL REFERENCES rating_pack (id) ON DELETE CASCADE,
  rater TEXT NOT NULL,
  name TEXT NOT NULL CHECK (name <> ''), -- random; the film's file in the rater's folder
  position INTEGER NOT NULL, -- order in which the rater is shown them
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  PRIMARY KEY (pack, rater, name)
) STRICT, WITHOUT ROWID;

-- Which of a protocol's groups is "group 1" until its analysis is locked: drawn once.
CREATE TABLE group_mask (
  protocol_sha256 TEXT PRIMARY KEY CHECK (length(protocol_sha256) = 64),
  swapped INTEGER NOT NULL CHECK (swapped IN (0, 1)), -- 1: the protocol's second population is group 1
  drawn_utc TEXT NOT NULL
) STRICT, WITHOUT ROWID;

-- An analysis as it stood when it was locked, after which its groups are named.
CREATE TABLE analysis_lock (
  protocol_sha256 TEXT PRIMARY KEY CHECK (length(protocol_sha256) = 64),
  protocol TEXT NOT NULL CHECK (protocol <> ''), -- name and version
  options TEXT NOT NULL, -- choices of the study beside the protocol, a line each
  values_sha256 TEXT NOT NULL CHECK (length(values_sha256) = 64), -- of attempts, groups and values as the study read them
  software TEXT NOT NULL, -- and its simulation version
  locked_utc TEXT NOT NULL,
  locked_by TEXT NOT NULL CHECK (locked_by <> '')
) STRICT, WITHOUT ROWID;
CREATE TRIGGER analysis_lock_keeps_rows BEFORE DELETE ON analysis_lock BEGIN SELECT RAISE(ABORT, 'locks are kept'); END;
CREATE TRIGGER analysis_lock_keeps_words BEFORE UPDATE ON analysis_lock BEGIN SELECT RAISE(ABORT, 'locks are kept'); END;
