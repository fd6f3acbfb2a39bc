# SPDX-License-Identifier: Apache-2.0
"""Compares the pages with the tree: links, paths, names, commands, options, HTTP calls, configuration keys."""

import pathlib
import re
from typing import NamedTuple

from pages import LINKS_ONLY, SPAN, Page

# Placeholders for a part of a path: `tests/fuzz/NAME_fuzzer.cpp`.
PLACEHOLDER = re.compile(r"[A-Z]{3,}(?=[_./]|$)")
# Generated at run time, not part of the tree.
MADE = ("maps/built/",)

PATH = re.compile(r"(?<![\w./:-])[\w.-]+(?:/[\w.,{}*-]*)+")
IDENTIFIER = re.compile(r"(?:\w+::)*(?:[A-Z][a-z0-9]+){2,}\w*(?:::\w+)*|[A-Z]\w*(?:::\w+)+")


class Problem(NamedTuple):
    page: str
    line: int
    what: str

    def __str__(self):
        return f"{self.page}:{self.line}: {self.what}"


def exists(tree, path):
    """True for a path of the tree; `a/{b,c}`, `*` and placeholders in capitals match several."""
    if path.startswith(MADE):
        return True
    alternatives = [path]
    while any("{" in one for one in alternatives):
        alternatives = [re.sub(r"\{[^{}]*\}", choice, one, count=1) for one in alternatives
                        for choice in re.search(r"\{([^{}]*)\}", one + "{}").group(1).split(",")]
    for one in alternatives:
        pattern = PLACEHOLDER.sub("*", one).rstrip("/")
        if not (any(tree.root.glob(pattern)) if "*" in pattern else (tree.root / pattern).exists()):
            return False
    return True


def hint(tree, path):
    """Hint with the actual path of a file of this name."""
    name = pathlib.PurePosixPath(path).name
    found = [file.relative_to(tree.root).as_posix() for folder in sorted(tree.folders - {"build"})
             for file in (tree.root / folder).rglob(name)] if "*" not in name and "{" not in name else []
    return f"; there is {found[0]}" if len(found) == 1 else ""


def check_links(tree):
    problems = []
    others = [Page(tree.root, tree.root / name) for name in LINKS_ONLY if (tree.root / name).exists()]
    for page in tree.pages + others:
        for line, target in page.links():
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            file = (page.file.parent / path).resolve() if path else page.file
            if not file.exists():
                problems.append(Problem(page.name, line, f"the link {target} leads nowhere"))
            elif anchor and file.suffix == ".md" and anchor not in Page(tree.root.resolve(), file.resolve()).anchors():
                problems.append(Problem(page.name, line, f"{path or 'this page'} has no heading #{anchor}"))
    return problems


def check_paths(tree):
    """Checks paths such as `core/io/survey.cpp` in code spans and blocks."""
    problems = []
    for page in tree.pages:
        for line, text in page.code():
            for path in PATH.findall(text):
                path = path.rstrip(".,")
                if path.split("/")[0] in tree.folders - {"build"} and not exists(tree, path):
                    problems.append(Problem(page.name, line, f"{path} does not exist{hint(tree, path)}"))
    return problems


def check_identifiers(tree):
    """Checks names of types and functions in code spans."""
    problems = []
    for page in tree.pages:
        for line, text in page.spans:
            if IDENTIFIER.fullmatch(text):
                missing = [word for word in text.split("::") if word not in tree.words]
                problems += [Problem(page.name, line, f"no source has {word}") for word in missing]
    return problems


def check_run(tree):
    """Checks ./run SUBCOMMAND and ./run bench NAME."""
    problems = []
    for page in tree.pages:
        for line, text in page.code():
            for words in re.findall(r"\./run((?: [a-z]+\b(?![./]))*)", text):
                words = words.split()
                known = [" ".join(words[:count]) for count in ((1, 2) if words[:1] == ["bench"] else (1,)) if words]
                for command in known:
                    if not re.search(rf"^  {command}\b", tree.run_help, re.M):
                        problems.append(Problem(page.name, line, f"./run has no '{command}'"))
    return problems


def check_commands(tree):
    """Checks that mentioned subcommands and options exist, and that existing ones are mentioned."""
    problems, mentioned = [], set()
    for page in tree.pages:
        mentioned |= {option for _, text in page.code() for option in re.findall(r"--[a-z][\w-]*", text)}
        for line, text in page.code():
            for program, rest in re.findall(r"(floorloc-mapbuilder|floorloc-server|floorloc-bridge) ([^|;#\n]*)", text):
                words = rest.split()
                options = tree.bridge_options if program == "floorloc-bridge" else tree.server_options
                if program == "floorloc-mapbuilder":
                    if not words or not re.fullmatch(r"[a-z][a-z-]*", words[0]):
                        continue
                    options = tree.subcommands.get(words[0], None)
                    if options is None:
                        problems.append(Problem(page.name, line, f"{program} has no subcommand '{words[0]}'"))
                        continue
                problems += [Problem(page.name, line, f"{program} has no option {word} here")
                             for word in words if word.startswith("--") and word not in options]
    everything = "\n".join(page.text for page in tree.pages)
    for name, options in tree.subcommands.items():
        if not re.search(rf"floorloc-mapbuilder {name}\b", everything):
            problems.append(Problem("docs", 1, f"the subcommand '{name}' is not documented"))
        problems += [Problem("docs", 1, f"the option {option} of '{name}' is not documented")
                     for option in sorted(options - mentioned - {"--help"})]
    for page, program, options in (("docs/server.md", "floorloc-server", tree.server_options),
                                   ("docs/vda5050.md", "floorloc-bridge", tree.bridge_options)):
        problems += [Problem(page, 1, f"the option {option} of {program} is not documented")
                     for option in sorted(options - mentioned - {"--help"})]
    return problems


def both_ways(page, what, documented, real):
    return [Problem(page, 1, f"{what} {one} does not exist") for one in sorted(documented - real)] + [
        Problem(page, 1, f"{what} {one} is not documented") for one in sorted(real - documented)]


def first_cells(page, heading):
    """The code spans in the first column of the tables under a heading of level two."""
    section = re.search(rf"^## {heading}$(.*?)(?=^## |\Z)", page.prose, re.M | re.S)
    return set(re.findall(r"^\| `([^`]+)` \|", section.group(1), re.M)) if section else set()


def check_server_page(tree):
    """Checks that documented configuration keys and HTTP calls exist, and that existing ones are documented."""
    pages = [page for page in tree.pages if page.name == "docs/server.md"]
    if not pages:
        return [Problem("docs/server.md", 1, "is missing")]
    calls = {cell for cell in first_cells(pages[0], "Calls") if re.match(r"(GET|PUT|POST|DELETE|PATCH) /", cell)}
    return both_ways("docs/server.md", "the configuration key", first_cells(pages[0], "Configuration"),
                     tree.config_keys) + both_ways("docs/server.md", "the call", calls, tree.calls)


def check_layout(tree):
    """Checks that every folder with sources of the product is in the layout of the architecture page."""
    page = tree.root / "docs/architecture.md"
    layout = page.read_text(encoding="utf-8") if page.exists() else ""
    folders = {file.parent for part in ("core", "mapbuilder", "server", "clients")
               for file in (tree.root / part).rglob("*.h")}
    return [Problem("docs/architecture.md", 1, f"{folder.relative_to(tree.root)}/ is missing in the layout")
            for folder in sorted(folders) if not re.search(rf"(?<![\w]){folder.name}/", layout)]


def check_traces(tree):
    """Checks table rows with files in the last column: the functions in the column before must occur in these files."""
    problems = []
    for page in tree.pages:
        for number, line in enumerate(page.text.splitlines(), start=1):
            cells = [SPAN.findall(cell) for cell in line.strip("|").split("|")] if line.startswith("| ") else []
            files = [tree.root / span for _, span in cells[-1]] if cells else []
            if len(cells) < 3 or not files or not all(file.is_file() for file in files):
                continue
            headers = [file.with_suffix(".h") for file in files if file.suffix == ".cpp"]
            words = {word for file in files + headers if file.exists()
                     for word in re.findall(r"\w+", file.read_text(encoding="utf-8"))}
            problems += [Problem(page.name, number, f"{span} is in none of the files of its row")
                         for _, span in cells[-2] if IDENTIFIER.fullmatch(span) and span.split("::")[-1] not in words]
    return problems


def check_messages(tree):
    """Checks that the programs have the messages of docs/troubleshooting.md; "…" stands for what differs."""
    problems = []
    for page in (page for page in tree.pages if page.name == "docs/troubleshooting.md"):
        for number, line in enumerate(page.text.splitlines(), start=1):
            spans = SPAN.findall(line.split(" | ")[0]) if line.startswith("| `") else []
            problems += [Problem(page.name, number, f"no program says '{part.strip()}'")
                         for _, span in spans for part in span.split("…")
                         if part.strip() and part.strip() not in tree.literals]
    return problems


CHECKS = (check_links, check_paths, check_identifiers, check_run, check_commands, check_server_page, check_layout,
          check_traces, check_messages)
