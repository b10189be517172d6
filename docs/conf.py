"""How Sphinx builds the documentation: make docs, and make docs-gallery with everything executed."""

from importlib.metadata import version as installed

from docutils import nodes
from docutils.nodes import Element, SkipNode, document
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.docutils import SphinxTranslator

project = "Torquer"
version = release = installed("torquer")
copyright = "Apache-2.0"
extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx_gallery.gen_gallery"]

html_theme = "pydata_sphinx_theme"
html_title = "Torquer"
html_theme_options = {
    "header_links_before_dropdown": 7,
    "show_prev_next": False,
    "navigation_with_keys": False,
    "footer_start": [],
    "footer_end": [],
}
html_context = {"default_mode": "auto"}
html_show_sourcelink = False
html_copy_source = False
html_static_path = ["_static"]
html_css_files = ["torquer.css"]
html_extra_path = ["scenario.schema.json"]
html_math_renderer = "mathml"
exclude_patterns = ["gallery/*.ipynb", "gallery/*.py"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
nb_execution_mode = "off"
nb_execution_timeout = 600
nb_execution_in_temp = True
nb_execution_raise_on_error = True

autodoc_typehints = "description"
autodoc_member_order = "bysource"
autodoc_default_options = {"exclude-members": "__new__, __init__"}
napoleon_numpy_docstring = False
nitpick_ignore_regex = [  # documented elsewhere; a build needs no network, and so looks at no inventory
    (r"py:.*", r"(pathlib|collections|os|typing|numpy|np|pandas|pd|xarray|xr|pydantic|matplotlib)\..*"),
    (r"py:.*", r"(sim|fsw|torquer\.api)\..*"),  # inner parts, which docs/design.md describes
]

EVIDENCE = (
    "validation",
    "population",
    "faults",
    "methods",
    "comparison",
    "pulse-limits",
    "performance",
    "basilisk",
    "scaling",
)
EVIDENCE += ("firmware-qemu", "soak", "mutation", "replay")
"""Pages that evidence.md leads to; they are in no menu."""

html_sidebars = dict.fromkeys(("index", "quickstart", "tutorial", *EVIDENCE), ())
"""Pages with none below them have no side bar, which would be empty."""

WIDE = 5
"""Columns from which on a table is too wide for a telephone."""

LONG = 30
"""Letters of a cell from which on it has a line of its own there."""

plot_gallery = "False"  # sphinx-gallery reads a text here
sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/\w+\.py",
    "within_subsection_order": "FileNameSortKey",
    "download_all_examples": False,
    "show_memory": False,
    "write_computation_times": False,
    "remove_config_comments": True,
    "abort_on_example_error": True,
}


def _inline(translator: SphinxTranslator, node: Element) -> None:
    translator.body.append(tex2mathml(node.astext(), as_block=False))
    raise SkipNode


def _display(translator: SphinxTranslator, node: Element) -> None:
    translator.body.append(f'<div class="math">{tex2mathml(node.astext(), as_block=True)}</div>')
    raise SkipNode


def _name_cells(app: Sphinx, doctree: document, page: str) -> None:
    """Give each cell of a wide table the name of its column, which the style shows on a narrow screen."""
    if app.builder.format != "html":
        return
    for table in doctree.findall(nodes.table):
        names = [entry.astext() for head in table.findall(nodes.thead) for entry in head.findall(nodes.entry)]
        if len(names) < WIDE:
            continue
        table["classes"].append("wide")
        for row in (row for body in table.findall(nodes.tbody) for row in body.findall(nodes.row)):
            for name, cell in zip(names, row.findall(nodes.entry), strict=True):
                if cell.astext():
                    cell["classes"] += ["long"] if len(cell.astext()) > LONG else []
                    cell.insert(0, nodes.inline("", name, classes=["column"]))


def _leave_out(app: Sphinx, env: BuildEnvironment) -> None:
    for name in EVIDENCE:
        env.metadata[name]["orphan"] = ""


def setup(app: Sphinx) -> None:
    """Equations become MathML, which browsers show without scripts or a network."""
    app.connect("env-updated", _leave_out)
    app.connect("doctree-resolved", _name_cells)
    app.add_html_math_renderer("mathml", (_inline, None), (_display, None))
