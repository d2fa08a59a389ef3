-- SPDX-License-Identifier: GPL-3.0-or-later
-- What users' own scripts computed of attempts (docs/how-to/own-metrics.md). Nothing here can be run: of a script there is its hash alone.

-- A version of a name stands for one source.
CREATE TABLE external_metric (
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL CHECK (name <> ''),
  version INTEGER NOT NULL CHECK (version >= 1),
  title TEXT NOT NULL CHECK (title <> ''),
  unit TEXT NOT NULL CHECK (unit <> ''),
  direction INTEGER NOT NULL CHECK (direction BETWEEN 0 AND 2), -- none, lower, higher is better
  sha256 TEXT NOT NULL CHECK (length(sha256) = 64), -- of the script's bytes
  registered_utc TEXT NOT NULL,
  UNIQUE (name, version)
) STRICT;

-- A value, or the reason why there is none. Of an attempt's rows of one name the newest version counts.
CREATE TABLE external_value (
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  metric INTEGER NOT NULL REFERENCES external_metric (id),
  availability INTEGER NOT NULL CHECK (availability IN (0, 2)), -- value, not available
  value REAL,
  reason TEXT NOT NULL DEFAULT '',
  note TEXT NOT NULL DEFAULT '',
  PRIMARY KEY (attempt, metric),
  CHECK ((availability = 0) = (value IS NOT NULL)),
  CHECK ((availability = 0) = (reason = ''))
) STRICT, WITHOUT ROWID;
