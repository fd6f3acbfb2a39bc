# SPDX-License-Identifier: Apache-2.0
"""Parses the pages, and the parts of the repository that pages refer to."""

import functools
import pathlib
import re
import subprocess

# Checked pages; the changelog is not, as its names and paths may no longer exist.
PAGES = ("README.md", "CONTRIBUTING.md", "docs/**/*.md", "tests/README.md", "schema/README.md", "maps/README.md",
         "examples/README.md", "clients/python/README.md")
LINKS_ONLY = ("CHANGELOG.md",)

FENCE = re.compile(r"^[ \t]*```[^\n]*\n(.*?)^[ \t]*```[ \t]*$", re.M | re.S)
SPAN = re.compile(r"(`+)(?!`)(.+?)(?<!`)\1(?!`)", re.S)
LINK = re.compile(r"!?\[[^\]]*\]\(([^()\s]+)\)")


class Page:
    """A page, its code and its prose, with line numbers."""

    def __init__(self, root, file):
        self.file = file
        self.name = file.relative_to(root).as_posix()
        self.text = file.read_text(encoding="utf-8")
        self.prose = FENCE.sub(lambda match: "\n" * match.group().count("\n"), self.text)
        self.blocks = [(self.line_of(match.start(1)), match.group(1)) for match in FENCE.finditer(self.text)]
        self.spans = [(1 + self.prose.count("\n", 0, match.start()), " ".join(match.group(2).split()))
                      for match in SPAN.finditer(self.prose)]

    def line_of(self, position):
        return 1 + self.text.count("\n", 0, position)

    def code(self):
        """Lines of code as (line, text); lines that end in a backslash are joined with the next."""
        for start, block in self.blocks:
            joined, first = "", 0
            for offset, line in enumerate(block.splitlines()):
                first = first if joined else start + offset
                joined += line.removesuffix("\\")
                if not line.endswith("\\"):
                    yield first, joined
                    joined = ""
        yield from self.spans

    def links(self):
        without_spans = SPAN.sub(lambda match: " " * len(match.group()), self.prose)
        for match in LINK.finditer(self.prose):
            if without_spans[match.start():match.end()].strip(" "):
                yield 1 + self.prose.count("\n", 0, match.start()), match.group(1)

    def anchors(self):
        """Anchors of the headings, as GitHub generates them."""
        seen = {}
        for heading in re.findall(r"^#{1,6} +(.*?)#*$", self.prose, re.M):
            text = LINK.sub(lambda match: match.group().split("](")[0].lstrip("!["), heading).strip().lower()
            anchor = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
            seen[anchor] = seen.get(anchor, -1) + 1
            yield anchor if seen[anchor] == 0 else f"{anchor}-{seen[anchor]}"


class Tree:
    """The parts of the repository that pages refer to."""

    def __init__(self, root):
        self.root = pathlib.Path(root)

    @functools.cached_property
    def pages(self):
        return [Page(self.root, file) for pattern in PAGES for file in sorted(self.root.glob(pattern))]

    def one(self, pattern):
        """The only file that matches a pattern, in any folder."""
        files = list(self.root.glob(pattern))
        if len(files) != 1:
            raise FileNotFoundError(f"{pattern} should name one file, and names {len(files)}")
        return files[0].read_text(encoding="utf-8")

    @functools.cached_property
    def folders(self):
        return {entry.name for entry in self.root.iterdir() if entry.is_dir() and not entry.name.startswith(".")}

    @functools.cached_property
    def words(self):
        """All identifiers of the sources."""
        words = set()
        for folder in ("core", "mapbuilder", "server", "web", "clients", "tests"):
            suffixes = {".py"} if folder == "clients" else set()
            for file in (self.root / folder).rglob("*"):
                if file.suffix in {".h", ".cpp", ".js", *suffixes} and "node_modules" not in file.parts:
                    words.update(re.findall(r"\w+", file.read_text(encoding="utf-8")))
        return words

    @functools.cached_property
    def literals(self):
        """The strings of the C++ sources, one per line; those that the compiler joins are joined."""
        texts = []
        for folder in ("core", "mapbuilder", "server"):
            for file in sorted((self.root / folder).rglob("*.[ch]*")):
                source = re.sub(r'"\s*\n\s*"', "", file.read_text(encoding="utf-8"))
                texts += [re.sub(r"\\(.)", r"\1", text) for text in re.findall(r'"((?:[^"\\\n]|\\.)*)"', source)]
        return "\n".join(texts)

    @functools.cached_property
    def run_help(self):
        result = subprocess.run(["bash", "run", "help"], cwd=self.root, capture_output=True, text=True, check=True)
        return result.stdout

    @functools.cached_property
    def subcommands(self):
        """Subcommand of floorloc-mapbuilder -> its options."""
        return {name: options for file in sorted(self.root.glob("mapbuilder/cli/*_command.cpp"))
                for name, options in subcommand_of(file)}

    @functools.cached_property
    def server_options(self):
        return options_of(self.one("server/daemon/main.cpp"))

    @functools.cached_property
    def bridge_options(self):
        return options_of(self.one("server/bridge/main.cpp"))

    @functools.cached_property
    def config_keys(self):
        return keys_of(self.one("server/**/config_json.cpp"))

    @functools.cached_property
    def calls(self):
        """The calls of openapi.yaml, such as "GET /v1/maps"."""
        calls, path = set(), None
        for line in self.one("schema/openapi.yaml").splitlines():
            if found := re.match(r"  (/\S*):$", line):
                path = found.group(1)
            elif line and not line.startswith("  "):
                path = None
            elif path and (found := re.match(r"    (get|put|post|delete|patch):$", line)):
                calls.add(f"{found.group(1).upper()} {path}")
        return calls


def options_of(source):
    """The options that a source adds with CLI11."""
    return set(re.findall(r'"!?(--[a-z][\w-]*)"\s*,\s*[^)]', source)) | {"--help"} | (
        {"--version"} if "--version" in source else set())


def subcommand_of(file):
    """Name and options of the subcommand that a source adds, including options from headers of the same folder."""
    source = file.read_text(encoding="utf-8")
    name = re.search(r'add_subcommand\(\s*"([\w-]+)"', source)
    options = options_of(source)
    for header in re.findall(r'#include "mapbuilder/cli/(\w+)\.h"', source):
        other = file.with_name(f"{header}.cpp")
        options |= options_of(other.read_text(encoding="utf-8")) if other.exists() else set()
    return [(name.group(1), options)] if name else []


def keys_of(source):
    """The keys that the configuration's parser reads, prefixed with their object."""
    bodies = dict(re.findall(r"^[\w:]+ (\w+)\([^)]*\) \{\n(.*?)^\}", source, re.M | re.S))
    keys = set()

    def collect(function, prefix):
        body = bodies[function]
        for callee, key in re.findall(r'(\w+)\(object\.Object\("(\w+)"\)', body):
            collect(callee, f"{prefix}{key}.")
        for callee in re.findall(r"(\w+)\(object, \w+(?:\.\w+)*\);", body):
            if callee in bodies and '"' in bodies[callee]:
                collect(callee, prefix)
        nested = set(re.findall(r'object\.Object\("(\w+)"\)', body))
        asked = set(re.findall(r'\bRead\w+\(object, "(\w+)"', body))
        asked |= set(re.findall(r'object\.(?:Has|Text|Number|Integer|Bool|Numbers)\("(\w+)"', body))
        keys.update(prefix + key for key in asked - nested)

    collect("ParseServerConfig", "")
    return keys
