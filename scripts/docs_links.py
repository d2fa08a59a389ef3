#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows every link of a built site: the file is there, its anchor too, and nothing is fetched from elsewhere.

The headers' reference in api/ has links of its tool's making, which are not followed; those that lead there are.

usage: docs_links.py SITE
"""
import html.parser
import pathlib
import sys
import urllib.parse

FETCHED = {("link", "href"), ("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src")}
FOLLOWED = FETCHED | {("a", "href")}


class Page(html.parser.HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.anchors, self.links = {""}, []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        self.anchors |= {values[name] for name in ("id", "name") if values.get(name)}
        self.links += [(tag, name, values[name]) for name in ("href", "src") if (tag, name) in FOLLOWED and values.get(name)]


def main():
    site = pathlib.Path(sys.argv[1]).resolve()
    pages = {p: Page(p.read_text(encoding="utf-8")) for p in sorted(site.rglob("*.html")) if p.name != "404.html" and p.relative_to(site).parts[0] != "api"}
    faults = links = 0
    for path, page in pages.items():
        for tag, name, link in page.links:
            links += 1
            parts = urllib.parse.urlsplit(link)
            fault = None
            if parts.scheme in ("http", "https") or parts.netloc:
                fault = "is fetched from elsewhere" if (tag, name) in FETCHED else None
            elif parts.scheme not in ("mailto", "data", "javascript"):
                target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
                target = target / "index.html" if target.is_dir() else target
                if not target.is_file():
                    fault = "leads nowhere"
                elif target in pages and urllib.parse.unquote(parts.fragment) not in pages[target].anchors:
                    fault = "has no such anchor"
            if fault:
                faults += 1
                print(f"{path.relative_to(site)}: {link}: {fault}")
    print(f"links: {len(pages)} pages, {links} links, {faults} faults")
    return 1 if faults or not pages else 0


if __name__ == "__main__":
    sys.exit(main())
