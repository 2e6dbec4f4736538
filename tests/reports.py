"""Results of short runs, and pages as parsers see them; what tests of the report share."""

from html.parser import HTMLParser
from pathlib import Path

from ltcgear.runtime import load
from ltcgear.runtime.cli.running import run

VOID = {"meta", "link", "input", "br", "img"}


def simulate_into(folder: Path, scene: str, t_end: float, changes=None, **options):
    """Simulate a scene into a file of a folder; return the file."""
    path = folder / f"{Path(scene).stem}.nc"
    run(scene, changes, path, t_end, "auto", 1e-6, 1, **options)
    return path


def load_run(folder: Path, scene: str, t_end: float, changes=None):
    """Simulate a scene and load its result file."""
    return load(simulate_into(folder, scene, t_end, changes))


class Page(HTMLParser):
    """What a page holds: elements with attributes in order, text outside scripts, and tags that do not close."""

    def __init__(self, text):
        super().__init__()
        self.open, self.elements, self.text, self.faults = [], [], "", []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs), list(self.open)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.elements.append((tag, dict(attrs), list(self.open)))

    def handle_endtag(self, tag):
        if not self.open or self.open[-1] != tag:
            self.faults.append((tag, self.getpos()))
        if tag in self.open:
            while self.open.pop() != tag:
                pass

    def handle_data(self, data):
        if not {"script", "style"} & set(self.open):
            self.text += data

    def find(self, tag, **wanted):
        """Return the attributes of all elements of a kind."""
        return [
            attrs
            for name, attrs, _ in self.elements
            if name == tag and all(attrs.get(key.rstrip("_")) == value for key, value in wanted.items())
        ]
