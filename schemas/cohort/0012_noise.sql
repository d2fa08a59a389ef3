-- SPDX-License-Identifier: GPL-3.0-or-later
-- Rebuildable: rate and noise of the tracker whose samples a value is made of. What was stored before knows neither.

ALTER TABLE checkpoint_value ADD COLUMN rate REAL CHECK (rate > 0); -- samples a second; of both hands the lower; empty: not of samples, or not known
ALTER TABLE checkpoint_value ADD COLUMN noise REAL CHECK (noise >= 0); -- standard deviation of positions on each axis (m); of both hands the greater; empty as rate
