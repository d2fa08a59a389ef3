-- SPDX-License-Identifier: GPL-3.0-or-later
-- Fixed table: description of the raters, as guidelines for reporting reliability and agreement ask for it.

CREATE TABLE rater (
  name TEXT NOT NULL CHECK (length(name) BETWEEN 1 AND 64), -- pseudonym, as in rating
  criterion TEXT NOT NULL CHECK (criterion <> ''), -- experience, training, independence, ...
  value TEXT NOT NULL,
  PRIMARY KEY (name, criterion)
) STRICT, WITHOUT ROWID;
