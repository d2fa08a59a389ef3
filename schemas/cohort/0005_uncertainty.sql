-- SPDX-License-Identifier: GPL-3.0-or-later
-- Rebuildable: what `calot assess --uncertainty` learned of a value by running the attempt again with another step, mesh and constants.

-- An interval is of one value, to the bit: where the value beside it in checkpoint_value is another one, it says nothing.
CREATE TABLE value_interval (
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  name TEXT NOT NULL, -- checkpoint
  subject TEXT NOT NULL,
  version INTEGER NOT NULL, -- of the checkpoint
  method INTEGER NOT NULL CHECK (method >= 1), -- how intervals were made
  value REAL NOT NULL, -- SI, as all that follows
  step_effect REAL NOT NULL, -- change to steps of length zero, extrapolated
  mesh_effect REAL NOT NULL, -- change to elements of size zero, extrapolated
  constants_spread REAL NOT NULL CHECK (constants_spread >= 0), -- standard deviation over the assumed constants
  lower REAL,
  upper REAL,
  reason TEXT NOT NULL DEFAULT '', -- why there is no interval
  runs BLOB NOT NULL, -- the value in each run with other constants, doubles, least significant byte first; empty without an interval
  PRIMARY KEY (attempt, name, subject),
  CHECK ((lower IS NULL) = (upper IS NULL)),
  CHECK ((lower IS NULL) = (reason <> '')),
  CHECK (lower IS NULL OR (lower <= value AND value <= upper))
) STRICT, WITHOUT ROWID;
