"""Writes the pages of the site that follow from the code: gallery, command line, errors, Python and C++ reference, into docs/**/generated/."""

import ast
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
BUILD = Path(os.environ.get("TAXELSIM_BUILD", ROOT / "build/release"))
DOXYGEN_XML = BUILD / "docs/xml"
SECTIONS = "start", "how_to", "reference", "understand", "notes"

PROPER_NAMES = {"ppo": "PPO", "onnx": "ONNX", "mujoco": "MuJoCo", "newton": "Newton"}

CPP_SECTIONS = (
    "briefdescription detaileddescription innernamespace innerclass user-defined enum typedef func var "
    "public-type public-func public-static-func public-attrib public-static-attrib"
)

# Title and public headers of a page of the C++ reference.
CPP_PAGES = {
    "simulator": ("Devices, models, simulators", ["taxelsim", "device", "model", "simulator", "features", "output_table", "skin_variation", "contact_point", "contact_misses", "contact_type", "feature_table"]),
    "settings": ("Sensors, objects, skins", ["sensor", "three_axis_readout", "sensor_hints", "object", "simplification_stop", "stiffness", "pose"]),
    "scenes": ("Scenes, robots, tasks", ["scene", "robot", "control", "trajectory", "task", "verdict", "grasp", "contact_recording", "experiment"]),
    "runs": ("Runs and policies", ["generate", "evaluate", "evaluation_part", "grasp_evaluation", "environment", "policy", "progress"]),
    "data": ("Data sets and measurements", ["dataset", "counts_range", "measurement", "readings", "characterize", "compare", "cross_validate"]),
    "errors": ("Errors and log", ["error", "log"]),
}  # fmt: skip

# Title and modules of a page of the Python reference; the names of `taxelsim` itself are divided by PYTHON_NAMES.
PYTHON_MODULES = {
    "datasets": ("Data sets", ["taxelsim.dataset"]),
    "envs": ("Gymnasium environments", ["taxelsim.envs"]),
    "policies": ("Policies", ["taxelsim.policies"]),
    "mujoco": ("MuJoCo", ["taxelsim.mujoco"]),
    "mujoco_environments": ("Environments of other packages", ["taxelsim.mujoco.environments"]),
    "patterns": ("Patterns of taxels", ["taxelsim.patterns"]),
    "ray": ("Ray", ["taxelsim.ray"]),
    "recordings": ("Recordings", ["taxelsim.recordings"]),
    "export": ("Export", ["taxelsim.export"]),
}


def write(page: str, text: str) -> None:
    """Writes a page if its text is new, so that Sphinx reads only what changed."""
    file = DOCS / f"{page}.md"
    file.parent.mkdir(parents=True, exist_ok=True)
    if not file.exists() or file.read_text() != text:
        file.write_text(text)


def version() -> str:
    """The version that CMakeLists.txt states."""
    return re.search(r"project\(taxelsim VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def output_of(*words: str) -> str:
    """What a command prints."""
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True).stdout


def toctree(names: list[str], options: str = ":hidden:") -> str:
    """A table of contents for the pages of a folder."""
    return "```{toctree}\n" + options + "\n\n" + "\n".join(names) + "\n```\n"


def write_gallery() -> None:
    """A page with all pictures, and one for each program of examples/."""
    listed = tomllib.loads((ROOT / "examples/gallery.toml").read_text())["section"]
    text = "# Gallery\n\nEach program is short, stands alone and makes its picture. They run as tests.\n\n"
    names = []
    for section in listed:
        text += f"## {section['title']}\n\n::::{{grid}} 1 2 3 3\n:gutter: 3\n\n"
        for name in section["examples"]:
            names.append(name)
            sentence, rest, program = example_parts(name)
            title = " ".join(PROPER_NAMES.get(word, word) for word in name.split("_"))
            title = title[0].upper() + title[1:]
            picture = f"../../images/gallery/{name}.png"
            text += f":::{{grid-item-card}} {title}\n:link: {name}\n:link-type: doc\n:img-top: {picture}\n:img-alt: {sentence}\n\n{sentence}\n:::\n"
            body = f"# {title}\n\n{sentence}\n\n![{sentence}]({picture})\n\n{rest}\n\n`examples/{name}.py`:\n\n```python\n{program}```\n"
            write(f"start/generated/{name}", body)
        text += "::::\n\n"
    write("start/generated/gallery", text + toctree(names))


def example_parts(name: str) -> tuple[str, str, str]:
    """First sentence, text, and the program without its docstring."""
    source = (ROOT / f"examples/{name}.py").read_text()
    tree = ast.parse(source)
    sentence, _, rest = ast.get_docstring(tree).partition("\n")
    program = "".join(source.splitlines(keepends=True)[tree.body[0].end_lineno :]).lstrip("\n")
    return sentence, rest.strip(), program


def write_command_line() -> None:
    """The help of the program and of each subcommand."""
    help_text = output_of(BUILD / "bin/taxelsim", "--help")
    names = re.findall(r"^  ([a-z-]+)  +[A-Z]", help_text.split("Subcommands:")[1].split("Examples:")[0], re.MULTILINE)
    text = f"# Command line\n\nEvery subcommand prints this with `--help`.\n\n```text\n{help_text}```\n"
    for name in names:
        text += f"\n## {name}\n\n```text\n{output_of(sys.executable, '-m', 'taxelsim', name, '--help')}```\n"
    write("reference/generated/command_line", text.replace(str(ROOT) + "/", ""))


def write_errors() -> None:
    """Causes and remedies of errors, from the list of the package."""
    from taxelsim.error_list import ERRORS

    text = "# Errors\n\nEvery message is one line that says what was found, where, and what is allowed. This page adds causes and remedies. "
    text += "The exit status is 2 for input that can be corrected, 1 for devices and disks; in Python the classes below are raised.\n"
    for area in dict.fromkeys(error.area for error in ERRORS):
        text += f"\n## {area}\n"
        for error in ERRORS:
            if error.area == area:
                text += f"\n### {error.title}\n\n```text\n{error.example}\n```\n\n{error.cause} {error.remedy} (`{error.raised.__name__}`)\n"
    write("reference/generated/errors", text)


def write_python() -> None:
    """Pages for autodoc."""
    import importlib

    listed = {"python_api": ("The package", ["taxelsim"]), **PYTHON_MODULES}
    elsewhere = {name for _, modules in PYTHON_MODULES.values() for module in modules for name in importlib.import_module(module).__all__}
    for page, (title, modules) in listed.items():
        text = f"# {title}\n"
        for module in map(importlib.import_module, modules):
            kinds = {"Classes": [], "Functions": []}
            for name in sorted(module.__all__, key=str.lower):
                thing = getattr(module, name)
                is_here = page != "python_api" or name not in elsewhere or getattr(thing, "__module__", "").startswith("taxelsim._core")
                if callable(thing) and is_here:
                    kinds["Classes" if isinstance(thing, type) else "Functions"].append(name)
            text += f"\n`{module.__name__}`: {(module.__doc__ or '').strip().splitlines()[0]}\n"
            for heading, names in kinds.items():
                directive, options = ("autoclass", "   :members:\n   :undoc-members:\n") if heading == "Classes" else ("autofunction", "")
                blocks = "".join(f".. {directive}:: {module.__name__}.{name}\n{options}\n" for name in names)
                if blocks:
                    text += f"\n## {heading}\n\n```{{eval-rst}}\n{blocks}```\n"
        write(f"reference/generated/{page}", text)


def write_cpp() -> None:
    """Pages for Breathe, from the XML of Doxygen. Sphinx parses no initializer that is a lambda, a macro or designated."""
    for file in DOXYGEN_XML.glob("*.xml"):
        text = file.read_text()
        shorter = re.sub(r"<initializer>= *(\{\.|\[|\{\s*#|\{ *///).*?</initializer>", "", text, flags=re.DOTALL)
        if shorter != text:
            file.write_text(shorter)
    for page, (title, headers) in CPP_PAGES.items():
        text = f"# {title}\n"
        for header in headers:
            text += f"\n## {header}.h\n\n```{{eval-rst}}\n.. doxygenfile:: {header}.h\n   :sections: {CPP_SECTIONS}\n```\n"
        write(f"reference/generated/cpp_{page}", text)


def write_pages() -> None:
    """All generated pages."""
    write_gallery()
    write_command_line()
    write_errors()
    write_python()
    write_cpp()


def llms_text(env) -> str:
    """The list of all pages for language models, as llmstxt.org proposes."""
    lines = ["# taxelsim", "", "> Batched simulator of tactile sensing arrays on Vulkan, with a Python package.", ""]
    for section in SECTIONS:
        lines += [f"## {section.replace('_', ' ').capitalize()}", ""]
        pages = sorted(page for page in env.found_docs if page.startswith(section + "/"))
        lines += [f"- [{env.titles[page].astext()}]({page}.md)" for page in pages] + [""]
    return "\n".join(lines)
