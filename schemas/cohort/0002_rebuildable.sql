-- SPDX-License-Identifier: GPL-3.0-or-later
-- Rebuildable tables: replaying the recordings gives them again.

-- What the newest replay said.
CREATE TABLE verification (
  attempt INTEGER PRIMARY KEY REFERENCES attempt (id) ON DELETE CASCADE,
  verdict INTEGER NOT NULL CHECK (verdict BETWEEN 0 AND 4), -- verified, diverged, damaged, not checkable here, not checked
  detail TEXT NOT NULL DEFAULT '',
  software TEXT NOT NULL DEFAULT '',
  verified_utc TEXT NOT NULL
) STRICT;

-- One figure, or the reason why there is none.
CREATE TABLE checkpoint_value (
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  position INTEGER NOT NULL, -- order in which the registry lists them
  name TEXT NOT NULL,
  subject TEXT NOT NULL, -- '', 'left', 'right' or the organ
  version INTEGER NOT NULL,
  availability INTEGER NOT NULL CHECK (availability BETWEEN 0 AND 2), -- value, not applicable, not available
  value REAL,
  reason TEXT NOT NULL DEFAULT '',
  note TEXT NOT NULL DEFAULT '',
  unit TEXT NOT NULL, -- SI
  origin INTEGER NOT NULL CHECK (origin BETWEEN 0 AND 2), -- re-simulated, observables, samples
  filter TEXT NOT NULL,
  PRIMARY KEY (attempt, position),
  UNIQUE (attempt, name, subject),
  CHECK ((availability = 0) = (value IS NOT NULL)),
  CHECK ((availability = 0) = (reason = ''))
) STRICT, WITHOUT ROWID;
