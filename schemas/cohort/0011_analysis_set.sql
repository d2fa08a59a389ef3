-- SPDX-License-Identifier: GPL-3.0-or-later
-- Views: the one definition of people, attempts and values that studies analyse (docs/reference/cohort.md, "The analysis set"). The
-- program reads its rules from here; any other program reads the set from analysis_attempt and analysis_value. A migration that builds
-- a table named here anew drops the views first and makes them again.

-- A row for each rule that leaves an attempt out, in the order in which studies count them. Options of a study may waive the rules
-- synthetic, practice and branch; protocol, named cohort, key and attempt rule of a study leave out more.
CREATE VIEW attempt_left_out (attempt, position, rule, reason) AS
  SELECT a.id, 1, 'withdrawn', 'withdrawn from research' FROM attempt a JOIN research_withdrawal w ON w.participant = a.participant
  UNION ALL -- A cohort that records no consent at all keeps it elsewhere.
  SELECT a.id, 2, 'consent', 'no consent to research' FROM attempt a
    WHERE a.participant IS NOT NULL AND EXISTS (SELECT 1 FROM consent) AND NOT EXISTS
      (SELECT 1 FROM consent c WHERE c.participant = a.participant AND c.purpose IN ('research', 'study'))
      AND NOT EXISTS (SELECT 1 FROM research_withdrawal w WHERE w.participant = a.participant)
  UNION ALL
  SELECT attempt, 3, 'excluded', 'excluded by hand: ' || reason || ' (' || excluded_by || ')' FROM exclusion
  UNION ALL
  SELECT attempt, 4, 'unsound', 'recording diverged or damaged' FROM verification WHERE verdict IN (1, 2)
  UNION ALL
  SELECT a.id, 5, 'unverified', 'not verified yet' FROM attempt a
    WHERE NOT EXISTS (SELECT 1 FROM verification v WHERE v.attempt = a.id AND v.verdict <> 4)
  UNION ALL
  SELECT a.id, 6, 'incomplete', 'recording incomplete' FROM attempt a JOIN recording r ON r.attempt = a.id
    WHERE r.complete = 0 OR a.outcome = 0
  UNION ALL
  SELECT id, 7, 'technical', 'technical failure' FROM attempt WHERE outcome = 5
  UNION ALL
  SELECT id, 8, 'synthetic', 'synthetic (performer)' FROM attempt WHERE synthetic = 1
  UNION ALL
  SELECT id, 9, 'practice', 'practice' FROM attempt WHERE mode = 0
  UNION ALL
  SELECT id, 10, 'branch', 'branch of another attempt' FROM attempt WHERE parent_uuid <> ''
  UNION ALL
  SELECT id, 11, 'golden', 'golden recording' FROM attempt WHERE purpose = 'golden'
  UNION ALL
  SELECT a.id, 12, 'group', 'no group' FROM attempt a LEFT JOIN participant p ON p.id = a.participant
    WHERE coalesce(p.study_group, '') = '';

-- Studies compare attempts of one comparability key. `trial` numbers a participant's attempts of a key by start: `WHERE trial = 1`
-- takes the first of each.
CREATE VIEW analysis_attempt (attempt, participant, study_group, arm, site, scene, comparability_key, outcome, start_utc, trial, id) AS
  SELECT a.uuid, p.pseudonym, p.study_group, p.arm, p.site, a.scene, a.comparability_key, a.outcome, a.start_utc,
    row_number() OVER (PARTITION BY a.participant, a.comparability_key ORDER BY a.start_utc, a.uuid), a.id
  FROM attempt a JOIN participant p ON p.id = a.participant
  WHERE NOT EXISTS (SELECT 1 FROM attempt_left_out l WHERE l.attempt = a.id);

-- Their values, in SI; of a script's the newest version. A value that is not available, or not finite, is NULL. `of_phase`: of a single
-- phase of the procedure other than how long it lasted; studies take these with --phases.
CREATE VIEW analysis_value (attempt, participant, study_group, arm, site, comparability_key, outcome, trial, name, subject, version, value,
                            unit, availability, reason, origin, of_phase) AS
  SELECT a.attempt, a.participant, a.study_group, a.arm, a.site, a.comparability_key, a.outcome, a.trial, v.name, v.subject, v.version,
    iif(abs(v.value) <= 1.7976931348623157e308, v.value, NULL), v.unit, v.availability, v.reason, v.origin,
    v.name LIKE 'phase-%' AND v.name <> 'phase-duration'
  FROM analysis_attempt a JOIN checkpoint_value v ON v.attempt = a.id
  UNION ALL
  SELECT a.attempt, a.participant, a.study_group, a.arm, a.site, a.comparability_key, a.outcome, a.trial, m.name, '', m.version,
    iif(abs(v.value) <= 1.7976931348623157e308, v.value, NULL), m.unit, v.availability, v.reason, 3, 0
  FROM analysis_attempt a JOIN external_value v ON v.attempt = a.id JOIN external_metric m ON m.id = v.metric
  WHERE NOT EXISTS (SELECT 1 FROM external_value l JOIN external_metric n ON n.id = l.metric
                    WHERE l.attempt = a.id AND n.name = m.name AND n.version > m.version);
