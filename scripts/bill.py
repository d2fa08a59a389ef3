#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the software bill of materials of the source as SPDX, by reuse, the same bytes every time.

  bill.py ROOT --date SECONDS --output FILE

reuse names the time and a random document: here the time is that of the release, and the document is named after its content. Packages that
the programs are linked with are in the packages' own dependencies.
"""
import argparse
import hashlib
import pathlib
import re
import subprocess
import time
import uuid


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("root")
    parser.add_argument("--date", type=int, required=True)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    text = subprocess.run(["reuse", "--root", arguments.root, "spdx"], capture_output=True, text=True, check=True).stdout
    text = re.sub(r"(?m)^Created: .*$", "Created: " + time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime(arguments.date)), text)
    text = re.sub(r"(?m)^Creator: Person: .*\n", "", text)
    text = re.sub(r"(?m)^Creator: Organization: .*$", "Creator: Organization: The Calot authors ()", text)
    text = re.sub(r"(?m)^DocumentName: .*$", "DocumentName: calot", text)
    text = re.sub(r"(?m)^DocumentNamespace: .*$", "DocumentNamespace: ", text)
    name = uuid.UUID(bytes=hashlib.sha256(text.encode()).digest()[:16])
    text = text.replace("DocumentNamespace: ", f"DocumentNamespace: http://spdx.org/spdxdocs/spdx-v2.1-{name}", 1)
    arguments.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
