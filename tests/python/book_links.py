"""Every link of a built book leads somewhere: to a file that is there, and to a heading of it where one is named.

    python3 tests/python/book_links.py FOLDER
"""

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """Links and names of a page."""

    def __init__(self):
        super().__init__()
        self.links, self.names = [], set()

    def handle_starttag(self, tag, attrs):
        attrs = dict(attrs)
        self.names.update(attrs[key] for key in ("id", "name") if attrs.get(key))
        self.links.extend(attrs[key] for key in ("href", "src") if attrs.get(key))


def main(folder):
    pages = {}
    for path in folder.rglob("*.html"):
        # What is printed is all pages in one, and a page that is not found is shown from anywhere.
        if path.name not in ("print.html", "404.html"):
            pages[path.resolve()] = page = Page()
            page.feed(path.read_text(encoding="utf-8"))
    broken, checked = [], 0
    for path, page in sorted(pages.items()):
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            checked += 1
            to = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if to.is_dir():
                to = to / "index.html"
            if not to.exists() or folder.resolve() not in to.parents:
                broken.append(f"{path.name}: {link}: no such file")
            elif parts.fragment and to in pages and unquote(parts.fragment) not in pages[to].names:
                broken.append(f"{path.name}: {link}: no such heading")
    for line in broken:
        print(line)
    print(f"{len(pages)} pages, {checked} links, {len(broken)} broken")
    # A book of nothing has no broken links either.
    return 1 if broken or checked < 100 else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
