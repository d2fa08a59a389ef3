# SPDX-License-Identifier: GPL-3.0-or-later
"""What a cohort database holds, read with another program than ours."""

import hashlib
import pathlib
import sqlite3
from contextlib import closing, contextmanager


def opened(path):
    """A database that must be there. Not read-only: a program that was killed may have left a journal, which SQLite rolls back first."""
    return closing(sqlite3.connect(f"file:{path}?mode=rw", uri=True))


def seal(path):
    """Gives each page the checksum that Calot would write (docs/reference/cohort.md, "Pages")."""
    held = bytearray(pathlib.Path(path).read_bytes())
    size = int.from_bytes(held[16:18], "big")
    for number, end in enumerate(range(size, len(held) + 1, size), 1):
        page = bytes(held[end - size:end - 8]) + number.to_bytes(4, "little")
        held[end - 8:end] = hashlib.blake2b(page, digest_size=16).digest()[:8]
    pathlib.Path(path).write_bytes(held)


@contextmanager
def edited(path):
    """The database, to be changed past the program's rules but with its checksums."""
    with closing(sqlite3.connect(path)) as database:
        yield database
        database.commit()
    seal(path)


def content(path):
    """Every row of every table, without the moments at which they were written."""
    with opened(path) as database:
        tables = [row[0] for row in database.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name")]
        out = {}
        for table in tables:
            columns = [row[1] for row in database.execute(f"PRAGMA table_info({table})") if not row[1].endswith("_utc")]
            out[table] = sorted(map(repr, database.execute(f"SELECT {', '.join(columns)} FROM {table}")))
    return out


def query(path, sql):
    with opened(path) as database:
        return database.execute(sql).fetchall()


def figures(path):
    """Attempts, verdicts and values by uuid: numbers of rows follow the order of merging."""
    return sorted(query(path, "SELECT a.uuid, a.scene, a.outcome, a.start_utc, r.file_name, hex(r.chain_head), r.steps, v.verdict, v.detail, v.software "
                              "FROM attempt a JOIN recording r ON r.attempt = a.id JOIN verification v ON v.attempt = a.id")), sorted(
        map(repr, query(path, "SELECT a.uuid, c.position, c.name, c.subject, c.version, c.availability, c.value, c.reason, c.note, c.unit, c.origin, "
                              "c.filter FROM checkpoint_value c JOIN attempt a ON a.id = c.attempt")))
