-- SPDX-License-Identifier: GPL-3.0-or-later
-- Rebuildable: what samples cover of a value's window, and which kind of missing it is. The table is built anew, since a check cannot be changed.

CREATE TABLE checkpoint_value_new (
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  position INTEGER NOT NULL, -- order in which the registry lists them
  name TEXT NOT NULL,
  subject TEXT NOT NULL, -- '', 'left', 'right' or the organ
  version INTEGER NOT NULL,
  availability INTEGER NOT NULL CHECK (availability BETWEEN 0 AND 4), -- value, not applicable, not available, absent hand, too little coverage
  value REAL,
  reason TEXT NOT NULL DEFAULT '',
  note TEXT NOT NULL DEFAULT '',
  unit TEXT NOT NULL, -- SI
  origin INTEGER NOT NULL CHECK (origin BETWEEN 0 AND 2), -- re-simulated, observables, samples
  filter TEXT NOT NULL,
  coverage REAL CHECK (coverage BETWEEN 0 AND 1), -- share of the window that samples cover; empty: not of samples, or not known
  PRIMARY KEY (attempt, position),
  UNIQUE (attempt, name, subject),
  CHECK ((availability = 0) = (value IS NOT NULL)),
  CHECK ((availability = 0) = (reason = ''))
) STRICT, WITHOUT ROWID;
INSERT INTO checkpoint_value_new
  SELECT attempt, position, name, subject, version, availability, value, reason, note, unit, origin, filter, NULL FROM checkpoint_value;
DROP TABLE checkpoint_value;
ALTER TABLE checkpoint_value_new RENAME TO checkpoint_value;
