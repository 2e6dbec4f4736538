"""How Sphinx builds the site (`make site`): Markdown pages, a gallery that is executed, Python from docstrings."""

import logging
import re
from dataclasses import is_dataclass
from importlib.metadata import version as version_of
from pathlib import Path
from typing import Any

import matplotlib as mpl
from pygments.lexers.special import TextLexer
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError

mpl.use("agg")
logging.getLogger("pint").setLevel(logging.ERROR)  # it tells that rpm gets another meaning, which is meant

project = "ltcgear"
author = "ltcgear developers"
version = release = version_of("ltcgear")

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx_copybutton",
    "sphinx_gallery.gen_gallery",
]
exclude_patterns = ["_build", "gallery"]
suppress_warnings = ["config.cache"]  # sphinx-gallery's configuration holds a function

# Every heading can be linked to as on a forge: [contact](effects.md#contact).
myst_heading_anchors = 4
myst_links_external_new_tab = False

autosummary_generate = False
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 88
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

# Okabe and Ito's colours, told apart by colour-blind readers.
COLOURS = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#777777"]


def draw_in_our_colours(configuration: dict[str, Any], name: str) -> None:
    """Give every example the colours of ltcgear's own figures (sphinx-gallery begins each with matplotlib's)."""
    mpl.rcParams["axes.prop_cycle"] = mpl.cycler(color=COLOURS)


def scrape_own_figures(block: Any, block_vars: dict[str, Any], gallery_conf: dict[str, Any]) -> str:  # noqa: ANN401
    """Take the figures that ltcgear draws from an example's variables, for pyplot does not know them."""
    from matplotlib.figure import Figure
    from sphinx_gallery.scrapers import figure_rst

    taken = []
    for value in block_vars["example_globals"].values():
        if not isinstance(value, Figure) or value.get_gid() == "seen":
            continue
        value.set_gid("seen")
        if value.canvas.manager is None:  # pyplot's own have one until they are shown
            taken.append(next(block_vars["image_path_iterator"]))
            value.savefig(taken[-1], dpi=100)
    return figure_rst(taken, gallery_conf["src_dir"])


sphinx_gallery_conf = {
    "examples_dirs": "gallery",
    "gallery_dirs": "examples",
    "filename_pattern": r"/plot_",
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": (scrape_own_figures, "matplotlib"),
    "reset_modules": ("matplotlib", draw_in_our_colours),
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_signature": False,
    "write_computation_times": False,  # that page loads scripts from elsewhere
    "min_reported_time": 1,
    "remove_config_comments": True,
}

html_theme = "furo"
html_title = "ltcgear"
html_copy_source = False
html_show_copyright = False
html_static_path = ["_static"]
html_css_files = ["site.css"]
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

LOADED = re.compile(r'<(?:script|link|img|iframe)\b[^>]*?(?:src|href)="((?:https?:)?//[^"]+)"')


def refuse_foreign_files(app: Sphinx, error: Exception | None) -> None:
    """Stop where a page would load something from elsewhere, as mathematics by a script would."""
    pages = () if error else sorted(Path(app.outdir).rglob("*.html"))
    found = {f"{page.name}: {address}" for page in pages for address in LOADED.findall(page.read_text("utf-8"))}
    if found:
        raise ExtensionError("pages load files from elsewhere:\n" + "\n".join(sorted(found)))


def leave_out_fields(app: Sphinx, what: str, name: str, value: object, *rest: object) -> tuple[str, str] | None:
    """Show no signature of a dataclass: ltcgear makes it, and its fields are described."""
    return ("", "") if what == "class" and is_dataclass(value) else None


def setup(app: Sphinx) -> None:
    """Look at the pages once they are written; show CSV as plain text."""
    app.connect("autodoc-process-signature", leave_out_fields)
    app.add_lexer("csv", TextLexer)
    app.connect("build-finished", refuse_foreign_files)
