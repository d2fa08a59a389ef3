-- SPDX-License-Identifier: GPL-3.0-or-later
-- Fixed table: words that people put on attempts to find them again (docs/reference/cohort.md). Studies, norms and grades do not look
-- at them. Who added or removed one, and when, stands in audit.

CREATE TABLE attempt_tag (
  attempt INTEGER NOT NULL REFERENCES attempt (id) ON DELETE CASCADE,
  tag TEXT NOT NULL CHECK (length(tag) BETWEEN 1 AND 40),
  PRIMARY KEY (attempt, tag)
) STRICT, WITHOUT ROWID;
