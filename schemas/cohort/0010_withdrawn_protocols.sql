-- SPDX-License-Identifier: GPL-3.0-or-later
-- A protocol that had no data may be withdrawn, once; its row stays, and the audit says why and by whom.
ALTER TABLE protocol ADD COLUMN withdrawn_utc TEXT NOT NULL DEFAULT '';
DROP TRIGGER protocol_keeps_words;
CREATE TRIGGER protocol_keeps_words BEFORE UPDATE ON protocol
WHEN NOT (OLD.withdrawn_utc = '' AND NEW.withdrawn_utc <> '' AND NEW.id = OLD.id AND NEW.name = OLD.name AND NEW.version = OLD.version
          AND NEW.sha256 = OLD.sha256 AND NEW.text = OLD.text AND NEW.registered_utc = OLD.registered_utc
          AND NEW.registered_by = OLD.registered_by)
BEGIN SELECT RAISE(ABORT, 'protocols are kept'); END;

-- Imported motion is found by the bytes of its file, too.
CREATE INDEX recording_by_chain_head ON recording (chain_head);
