# SPDX-License-Identifier: GPL-3.0-or-later
"""Hooks of mkdocs.yml: pages of schemas/ are part of the site, and links into the source tree are named instead of followed.

What a page links to outside docs/ and schemas/ is a file of the sources, of which the site has no copy.
"""
import os
import pathlib
import posixpath
import re

from mkdocs.structure.files import File

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"(!?)\[((?:[^\]\[`]|`[^`]*`)*)\]\(([^)\s#]*)(#[^)\s]*)?\)")


def on_files(files, config):
    for path in sorted((ROOT / "schemas").rglob("*")):
        if path.suffix in (".md", ".json", ".sql"):
            files.append(File(path.relative_to(ROOT).as_posix(), str(ROOT), config["site_dir"], config["use_directory_urls"]))
    return files


def relinked(page, text):
    """The text of a page with links as the site has them. `page` is its path in the site."""
    # Where the page lies in the source tree.
    source = page if page.startswith("schemas/") else "docs/" + page

    def one(match):
        mark, label, target, anchor = match[1], match[2], match[3], match[4] or ""
        if not target or re.match(r"[a-z]+:", target):
            return match[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(source), target))
        if path.startswith("docs/"):
            inside = path[len("docs/"):]
        elif path.startswith("schemas/") and (ROOT / path).is_file():
            inside = path
        else:
            return label  # of the sources
        return f"{mark}[{label}]({os.path.relpath(inside, posixpath.dirname(page) or '.')}{anchor})"

    parts = re.split(r"(^```.*?^```$)", text, flags=re.MULTILINE | re.DOTALL)
    return "".join(part if i % 2 else LINK.sub(one, part) for i, part in enumerate(parts))


def on_page_content(html, page, config, files):
    """Long names in tables may break behind a dot, a slash or two colons."""
    if page.file.src_path == "index.md":  # scripts/docs.sh puts the reference of the headers there
        html = html.replace("<code>build/site/api</code>", '<a href="api/index.html"><code>api</code></a>')
    # A table without heads, as checkpoints have it.
    html = re.sub(r"<thead>\s*<tr>\s*(?:<th[^>]*></th>\s*)+</tr>\s*</thead>", "", html)
    return re.sub(r"(<td[^>]*>)(.*?)(?=</td>)", lambda cell: cell[1] + re.sub(
        r"<code>([^<]*)</code>", lambda code: "<code>" + re.sub(r"(\.(?=\w{3}|\*)|/|::)(?=\w|\*)", r"\1<wbr>", code[1]) + "</code>", cell[2]), html, flags=re.DOTALL)


def on_page_markdown(markdown, page, config, files):
    return relinked(page.file.src_path, markdown)
