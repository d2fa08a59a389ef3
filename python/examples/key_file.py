# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Names in a key file of Calot 0.2 and before
#
# `key_file.py FILE` prints pseudonym and name of each entry; the passphrase is read from CALOT_KEY_PASSPHRASE or typed. Earlier versions of Calot
# kept the names behind pseudonyms in such files. Keep them in a tool made for secrets (a password manager, an encrypted disk), never beside the
# cohort. Needs python3-nacl.
#
# Layout: 16 bytes "calot-key-file-1", 8 bytes each of Argon2id's passes and memory (little-endian), 16 of salt, 24 of nonce, then the sealed
# (XSalsa20-Poly1305) JSON object from pseudonym to name.

# %%
import getpass
import json
import os
import pathlib
import sys

MAGIC = b"calot-key-file-1"
MAX_PASSES, MAX_MEMORY = 16, 1 << 30  # larger ones could only serve to hang the reader


def names_in(data: bytes, passphrase: bytes) -> dict[str, str]:
    """Entries of a key file. Raises ValueError."""
    from nacl import exceptions, pwhash, secret
    if len(data) < 88 or not data.startswith(MAGIC):
        raise ValueError("not a key file, or damaged")
    passes, memory = (int.from_bytes(data[at:at + 8], "little") for at in (16, 24))
    if not 1 <= passes <= MAX_PASSES or not 8192 <= memory <= MAX_MEMORY or memory % 1024:
        raise ValueError("not a key file, or damaged")
    key = pwhash.argon2id.kdf(secret.SecretBox.KEY_SIZE, passphrase, data[32:48], opslimit=passes, memlimit=memory)
    try:
        return json.loads(secret.SecretBox(key).decrypt(data[72:], data[48:72]))
    except exceptions.CryptoError:
        raise ValueError("another passphrase, or damaged") from None


# %%
if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: key_file.py FILE")
    secret_words = os.environ.get("CALOT_KEY_PASSPHRASE") or getpass.getpass("passphrase: ")
    try:
        for pseudonym, name in sorted(names_in(pathlib.Path(sys.argv[1]).read_bytes(), secret_words.encode()).items()):
            print(f"{pseudonym}\t{name}")
    except (OSError, ValueError) as error:
        sys.exit(f"key_file: {sys.argv[1]}: {error}")
