-- SPDX-License-Identifier: GPL-3.0-or-later
-- Fixed tables of assessment: what was declared before the data, what people judged, and what others are held against.

-- A study's protocol as it was registered, byte for byte. The same name may be registered again with a higher version.
CREATE TABLE protocol (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  sha256 TEXT NOT NULL UNIQUE CHECK (length(sha256) = 64), -- of the text
  text TEXT NOT NULL,
  registered_utc TEXT NOT NULL,
  registered_by TEXT NOT NULL CHECK (registered_by <> ''),
  UNIQUE (name, version)
) STRICT;
CREATE TRIGGER protocol_keeps_rows BEFORE DELETE ON protocol BEGIN SELECT RAISE(ABORT, 'protocols are kept'); END;
CREATE TRIGGER protocol_keeps_words BEFORE UPDATE ON protocol BEGIN SELECT RAISE(ABORT, 'protocols are kept'); END;

-- A form that was filled in, byte for byte.
CREATE TABLE form (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  sha256 TEXT NOT NULL UNIQUE CHECK (length(sha256) = 64),
  text TEXT NOT NULL,
  UNIQUE (name, version)
) STRICT;

-- What a rater answered about an attempt; an item that was left blank has no row.
CREATE TABLE rating (
  form INTEGER NOT NULL REFERENCES form (id),
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  rater TEXT NOT NULL CHECK (length(rater) BETWEEN 1 AND 64), -- pseudonym
  item TEXT NOT NULL,
  score INTEGER NOT NULL,
  rated_utc TEXT NOT NULL,
  PRIMARY KEY (form, attempt, rater, item)
) STRICT, WITHOUT ROWID;

-- What a participant answered about the simulator.
CREATE TABLE questionnaire (
  form INTEGER NOT NULL REFERENCES form (id),
  participant INTEGER NOT NULL REFERENCES participant (id) ON DELETE CASCADE,
  item TEXT NOT NULL,
  score INTEGER NOT NULL,
  rated_utc TEXT NOT NULL,
  PRIMARY KEY (form, participant, item)
) STRICT, WITHOUT ROWID;

-- A named, versioned cohort that others are held against, frozen with its cuts when it is made.
CREATE TABLE norm (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  comparability_key TEXT NOT NULL,
  judged_by TEXT NOT NULL, -- what says who is competent: "group expert against novice", "form competence 1, ..."
  least_passed INTEGER NOT NULL CHECK (least_passed >= 0), -- of the checkpoints in the rule; 0: all of them
  members INTEGER NOT NULL CHECK (members >= 0), -- when it was made; participants who withdraw leave it
  synthetic INTEGER NOT NULL CHECK (synthetic IN (0, 1)),
  seed TEXT NOT NULL, -- of the bootstrap, unsigned 64 bits in decimal
  created_utc TEXT NOT NULL,
  created_by TEXT NOT NULL CHECK (created_by <> ''),
  UNIQUE (name, version)
) STRICT;

CREATE TABLE norm_member (
  norm INTEGER NOT NULL REFERENCES norm (id) ON DELETE CASCADE,
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  competent INTEGER NOT NULL CHECK (competent IN (0, 1)),
  PRIMARY KEY (norm, attempt)
) STRICT, WITHOUT ROWID;

-- Pass mark of a checkpoint, in its SI unit, or the reason why there is none.
CREATE TABLE norm_checkpoint (
  norm INTEGER NOT NULL REFERENCES norm (id) ON DELETE CASCADE,
  position INTEGER NOT NULL, -- in the sheet
  checkpoint TEXT NOT NULL,
  subject TEXT NOT NULL,
  version INTEGER NOT NULL, -- of the checkpoint
  direction INTEGER NOT NULL CHECK (direction IN (1, 2)), -- lower, higher is better
  log_scale INTEGER NOT NULL CHECK (log_scale IN (0, 1)),
  in_rule INTEGER NOT NULL CHECK (in_rule IN (0, 1)),
  cut REAL,
  lower REAL, -- 95 % interval of the cut, where there is one
  upper REAL,
  reason TEXT NOT NULL DEFAULT '', -- why there is no cut, or no interval
  PRIMARY KEY (norm, checkpoint, subject),
  CHECK (in_rule = 0 OR cut IS NOT NULL),
  CHECK ((lower IS NULL) = (upper IS NULL))
) STRICT, WITHOUT ROWID;

-- Members' values of these checkpoints when the norm was made, in SI.
CREATE TABLE norm_value (
  norm INTEGER NOT NULL REFERENCES norm (id) ON DELETE CASCADE,
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  checkpoint TEXT NOT NULL,
  subject TEXT NOT NULL,
  value REAL NOT NULL,
  PRIMARY KEY (norm, attempt, checkpoint, subject)
) STRICT, WITHOUT ROWID;

-- What a site puts forward for grading by this norm; without any, every sheet is formative.
CREATE TABLE norm_evidence (
  id INTEGER PRIMARY KEY,
  norm INTEGER NOT NULL REFERENCES norm (id) ON DELETE CASCADE,
  statement TEXT NOT NULL CHECK (statement <> ''),
  file_name TEXT NOT NULL,
  sha256 TEXT NOT NULL CHECK (length(sha256) = 64), -- of the file
  attached_by TEXT NOT NULL CHECK (attached_by <> ''),
  attached_utc TEXT NOT NULL
) STRICT;
