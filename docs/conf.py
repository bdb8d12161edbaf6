"""Configuration of the documentation site: Sphinx with MyST. `scripts/docs` builds it and sets the environment variables below."""

import re
import sys
from pathlib import Path

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS))

import generate  # noqa: E402
from docutils import nodes  # noqa: E402
from latex2mathml.converter import convert  # noqa: E402
from pygments.lexers.special import TextLexer  # noqa: E402

project = "taxelsim"
author = copyright = "the taxelsim authors"
version = release = generate.version()
extensions = [
    "myst_parser",
    "sphinx_design",
    "sphinx_copybutton",
    "sphinx.ext.autodoc",
    "breathe",
]
exclude_patterns = ["Doxyfile.in"]
html_theme = "furo"
html_title = "taxelsim"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {"navigation_with_keys": True}
html_math_renderer = "mathml"
myst_enable_extensions = ["colon_fence", "dollarmath", "attrs_inline"]
myst_heading_anchors = 4
autodoc_member_order = "bysource"
autodoc_typehints = "description"
copybutton_exclude = ".linenos, .gp"
breathe_projects = {"taxelsim": str(generate.DOXYGEN_XML)}
breathe_default_project = "taxelsim"
suppress_warnings = ["duplicate_declaration.c", "duplicate_declaration.cpp"]  # each header has the namespace, some define a macro anew

OUTSIDE = re.compile(r"(?<!!)\[([^]]*)\]\(((?:\.\./)+[^)\s#]*)(#[^)\s]*)?\)")


def name_outside_files(app, page, source):
    """A link to a file of the repository outside of docs/ becomes the name of that file: the site does not have it."""
    folder = (DOCS / page).parent

    def as_name(link):
        target = (folder / link[2]).resolve()
        if target.is_relative_to(DOCS):
            return link[0]
        path = target.relative_to(DOCS.parent).as_posix() + ("/" if link[2].endswith("/") else "")
        text = link[1].strip("`")
        return f"`{path}`" if path.rstrip("/").endswith(text.rstrip("/")) else f"{link[1]} (`{path}`)"

    source[0] = OUTSIDE.sub(as_name, source[0])


FIELD = re.compile(r"^(\w+(?:, \w+)*): (?=\S)")


def as_restructured_text(app, what, name, obj, options, lines):
    """Docstrings of the package are plain text: `name: text` explains an argument, an indented line continues the one above."""
    text = "\n".join(lines)
    text = re.sub(r"(?<!`)`([^`]+)`(?!`)", r"``\1``", text)
    text = re.sub(r"(?<![`\w])(\*{1,2})(?=\w)", lambda stars: "\\*" * len(stars[1]), text)
    paragraphs, in_item = [], False
    for line in text.split("\n"):
        if FIELD.match(line):
            paragraphs += ["", FIELD.sub(r"* ``\1``: ", line)]
            in_item = True
        elif line.startswith(" ") and in_item:
            paragraphs.append("  " + line.strip())
        else:
            paragraphs += ["", line] if line and in_item else [line]
            in_item = False
    lines[:] = [*paragraphs, ""]


def as_mathml(translator, node):
    """Writes a formula as MathML, which browsers draw themselves."""
    display = "block" if isinstance(node, nodes.math_block) else "inline"
    translator.body.append(convert(node.astext(), display=display))
    raise nodes.SkipNode


def write_markdown(app, error):
    """Writes every page as Markdown into the folder of its HTML, and llms.txt, which lists these files."""
    if error is not None or app.builder.name != "html":
        return
    out = Path(app.outdir)
    for page in app.env.found_docs:
        source = [(DOCS / f"{page}.md").read_text()]
        name_outside_files(app, page, source)
        target = out / f"{page}.md"
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(source[0])
    (out / "llms.txt").write_text(generate.llms_text(app.env))


def setup(app):
    """Connects the functions above."""
    generate.write_pages()
    app.connect("source-read", name_outside_files)
    app.connect("autodoc-process-docstring", as_restructured_text)
    app.connect("build-finished", write_markdown)
    for name in ("obj", "csv"):
        app.add_lexer(name, TextLexer)
    app.add_html_math_renderer("mathml", (as_mathml, None), (as_mathml, None))

