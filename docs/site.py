"""What the docs site has beside the pages of this folder; a hook of mkdocs.

The navigation is the list in README.md. A page for each command is made of its help, one for each
room of the Python library of its docstrings, which are read and not imported. Links to files
outside of this folder lead to the repository, where pyproject.toml names it, or are plain words.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

import click
from mkdocs.structure.files import File

import rodsim
from rodsim import analysis
from rodsim.cli import COMMANDS, main

DOCS = Path(__file__).parent
LINK = re.compile(r"\[([^\]]+)\]\((?:\.\./)+([^)#]+)(#[^)]*)?\)")
ROW = re.compile(r"^\| \[[^\]]+\]\((?P<page>[^)]+\.md)\)|^## (?P<title>.+)", re.M)
LIBRARY = {  # of each page: title, names
    "rodsim": ("rodsim", [("rodsim", name) for name in rodsim._HOMES]),
    "analysis": (
        "rodsim.analysis",
        [(f"rodsim.analysis.{home}", n) for home, names in analysis._HOMES.items() for n in names],
    ),
}

INHERITED = {"Trajectory": "    options: {inherited_members: true}\n"}


def on_config(config):
    """Take the navigation from README.md, the address of the source from pyproject.toml."""
    project = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    urls = project.get("urls", {})
    config.repo_url = urls.get("Source")
    config.site_url = urls.get("Documentation")
    config.nav = [{"Overview": "README.md"}, *_listed()]
    config.nav.append({"Commands": [{f"rodsim {c}": f"commands/{c}.md"} for c in COMMANDS]})
    config.nav.append({"Python": [f"library/{name}.md" for name in LIBRARY]})
    return config


def _listed():
    sections = []
    for row in ROW.finditer((DOCS / "README.md").read_text(encoding="utf-8")):
        if row["title"]:
            sections.append({row["title"].partition(":")[0]: []})
        else:
            next(iter(sections[-1].values())).append(row["page"])
    return sections


def on_files(files, config):
    """Add the pages that are made."""
    made = {f"commands/{name}.md": _command(name) for name in COMMANDS}
    made |= {f"library/{name}.md": _room(*room) for name, room in LIBRARY.items()}
    for path, text in made.items():
        files.append(File.generated(config, path, content=text))
    return files


def _command(name):
    command = main.get_command(None, name)
    parent = click.Context(main, info_name="rodsim", **main.context_settings)
    context = click.Context(command, info_name=name, parent=parent, terminal_width=80)
    return f"# rodsim {name}\n\n```text\n{command.get_help(context)}\n```\n"


def _room(title, names):
    """Return a page of the docstrings of some names."""
    blocks = (f"::: {home}.{name}\n{INHERITED.get(name, '')}" for home, name in names)
    return "\n".join([f"# {title}\n", *blocks])


def on_page_markdown(markdown, page, config, files):
    """Lead links to files outside of this folder to the repository."""
    depth = page.file.src_uri.count("/")

    def lead(link):
        words, path, anchor = link.groups()
        if link[0].count("../") <= depth:
            return link[0]
        source = f"{config.repo_url}/blob/HEAD/{path}{anchor or ''}"
        return f"[{words}]({source})" if config.repo_url else words

    return LINK.sub(lead, markdown)
