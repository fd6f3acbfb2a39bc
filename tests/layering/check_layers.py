#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that includes and link lines only refer to lower layers. Usage: check_layers.py [ROOT]"""

import pathlib
import re
import sys
from typing import NamedTuple

# Folder -> the folders it may include, and transitively those that they may include. A folder may include itself.
ARROWS = {
    "core/geometry": [],
    "core/io": ["core/geometry"],
    "core/vision/image": ["core/geometry"],
    "core/vision/features": ["core/vision/image"],
    "core/vision/surf": ["core/vision/features"],
    "core/vision/freak_star": ["core/vision/features"],
    "core/vision/matching": ["core/vision/features"],
    "core/vision/extractors": ["core/vision/surf"],
    "core/vision": ["core/vision/image", "core/vision/features", "core/vision/surf", "core/vision/freak_star",
                    "core/vision/matching", "core/vision/extractors"],
    "core/registration": ["core/geometry"],
    "core/surface/texture": ["core/vision/image"],
    "core/surface/classes": ["core/io", "core/vision/image"],
    "core/surface": ["core/surface/texture", "core/surface/classes"],
    "core/map": ["core/vision", "core/geometry", "schema"],
    "core/photometry": ["core/map", "core/vision"],
    "core/lattice": ["core/photometry"],
    "core/localization": ["core/lattice", "core/registration", "core/surface"],
    "core/odometry": ["core/registration", "core/vision"],
    "core/fusion": ["core/geometry"],
    "core/tracking": ["core/localization", "core/odometry", "core/fusion"],
    "core/diagnosis": ["core/io", "core/tracking"],
    "core/evaluation": ["core/geometry", "core/io", "core/vision"],
    "mapbuilder/bag": ["core/io"],
    "mapbuilder/batch": ["core/io", "core/map"],
    "mapbuilder/coverage": ["core/geometry"],
    "mapbuilder/plot": ["core/evaluation"],
    "mapbuilder/fiducials": [],
    "mapbuilder/survey": ["core/odometry", "core/surface", "mapbuilder/batch"],
    "mapbuilder/simulation": ["mapbuilder/batch"],
    "mapbuilder/replay": ["core/diagnosis", "mapbuilder/batch"],
    "mapbuilder/placement": ["core/localization", "mapbuilder/coverage", "mapbuilder/survey"],
    "mapbuilder/heights": ["mapbuilder/placement"],
    "mapbuilder/keypoints": ["mapbuilder/coverage", "mapbuilder/survey"],
    "mapbuilder/screening": ["mapbuilder/placement"],
    "mapbuilder/self_calibration": ["mapbuilder/placement", "mapbuilder/keypoints"],
    "mapbuilder/markers": ["mapbuilder/fiducials", "mapbuilder/placement"],
    "mapbuilder/mosaic": ["mapbuilder/placement"],
    "mapbuilder/finished_map": ["mapbuilder/mosaic"],
    "mapbuilder/fleet": ["core/evaluation", "mapbuilder/simulation", "mapbuilder/finished_map", "clients/cpp"],
    "mapbuilder/extend": ["mapbuilder/finished_map"],
    "mapbuilder/merge": ["mapbuilder/finished_map"],
    "mapbuilder/export": ["mapbuilder/finished_map"],
    "mapbuilder/build": ["mapbuilder/screening", "mapbuilder/heights", "mapbuilder/self_calibration",
                         "mapbuilder/markers", "mapbuilder/extend"],
    "mapbuilder/calibration": ["mapbuilder/batch", "mapbuilder/fiducials"],
    "mapbuilder/unpack": ["mapbuilder/bag", "mapbuilder/calibration"],
    "mapbuilder/surface": ["core/registration", "core/surface/classes", "core/surface/texture", "mapbuilder/simulation"],
    "mapbuilder/laboratory": ["mapbuilder/plot", "mapbuilder/replay", "mapbuilder/mosaic", "mapbuilder/surface"],
    "mapbuilder/report": ["mapbuilder/plot", "mapbuilder/export", "mapbuilder/build"],
    "mapbuilder": ["mapbuilder/batch", "mapbuilder/coverage", "mapbuilder/plot", "mapbuilder/fiducials",
                   "mapbuilder/survey", "mapbuilder/simulation", "mapbuilder/replay", "mapbuilder/placement",
                   "mapbuilder/heights", "mapbuilder/keypoints", "mapbuilder/screening", "mapbuilder/self_calibration",
                   "mapbuilder/markers", "mapbuilder/mosaic", "mapbuilder/finished_map", "mapbuilder/extend",
                   "mapbuilder/merge", "mapbuilder/export", "mapbuilder/build"],
    "mapbuilder/cli": ["mapbuilder/fleet", "mapbuilder/merge", "mapbuilder/laboratory", "mapbuilder/calibration",
                       "mapbuilder/unpack", "mapbuilder/surface", "mapbuilder/report"],
    "server/wire": [],
    "server/http": ["core/io", "server/wire"],
    "server/config": ["core/localization", "server/http"],
    "server/store": ["core/io", "core/map", "server/wire", "schema"],
    "server/serving": ["core/diagnosis", "server/store"],
    "server/api": ["server/config", "server/serving", "web"],
    "server/daemon": ["server/api"],
    "server/bridge": ["server/wire", "clients/cpp"],
    "server": ["server/wire", "server/http", "server/config", "server/store", "server/serving", "server/api",
               "server/daemon"],
    "schema": [],
    "web": [],
    "clients/cpp": [],
}

# Target whose name is not its folder's -> its folder.
TARGETS = {"client": "clients/cpp"}

# Header of an external library -> the only places in the product that may include it.
LIBRARIES = {
    "httplib.h": ["server/http/", "server/bridge/map_download.cpp", "clients/cpp/client.cpp", "clients/cpp/events.cpp"],
    "mosquitto.h": ["server/bridge/mqtt_connection.cpp"],
    "sqlite3.h": ["core/map/", "mapbuilder/bag/"],
    "CLI/": ["mapbuilder/cli/", "server/daemon/main.cpp", "server/bridge/main.cpp"],
    "nlohmann/": ["core/map/", "mapbuilder/", "server/", "clients/cpp/"],
    "yaml-cpp/": ["core/io/"],
    "ceres/": ["mapbuilder/"],
    "spdlog/": ["mapbuilder/", "server/"],
    "opencv2/": ["core/io/", "core/vision/", "core/surface/", "core/map/", "core/photometry/", "core/lattice/",
                 "core/localization/", "core/odometry/", "core/evaluation/", "mapbuilder/", "server/"],
}

PRODUCT = ["core", "mapbuilder", "server", "schema", "web", "clients"]
# Targets that are not named after their folder.
TARGETS = {"client": "clients/cpp"}
FORBIDDEN_FOLDERS = {"util", "utils"}
NOT_OURS = {"build", ".git", "node_modules"}
INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')


class Problem(NamedTuple):
    file: str
    line: int
    what: str

    def __str__(self):
        return f"{self.file}:{self.line}: {self.what}"


def layer_of(path):
    """The deepest folder of the table that contains the path, or None."""
    holders = [layer for layer in ARROWS if path.startswith(layer + "/")]
    return max(holders, key=len, default=None)


def reachable(layer):
    """The layer and all layers below it."""
    found, open_layers = set(), [layer]
    while open_layers:
        current = open_layers.pop()
        if current not in found:
            found.add(current)
            open_layers += ARROWS[current]
    return found


def check_include(layer, path, quote, header):
    """Error message for this include; empty when it is allowed."""
    if quote == '"':
        target = layer_of(header)
        if target is None:
            return f'"{header}" is no header of a layer, by its path from the root'
        return "" if target in reachable(layer) else f'{layer} must not include {target} ("{header}")'
    for library, places in LIBRARIES.items():
        if header.startswith(library) and not path.startswith(tuple(places)):
            return f"<{header}> belongs to {', '.join(places)} only"
    return ""


def check_source(path, text):
    layer = layer_of(path)
    if layer is None:
        return [Problem(path, 1, "this folder is no layer; add it to the table of check_layers.py and to the design")]
    problems = []
    for number, line in enumerate(text.splitlines(), start=1):
        include = INCLUDE.match(line)
        if include:
            what = check_include(layer, path, *include.groups())
            problems += [Problem(path, number, what)] if what else []
    return problems


def check_own_header(file, path, text):
    """Checks that a source includes the header of its name first, so that the header compiles alone."""
    if file.suffix != ".cpp" or not file.with_suffix(".h").exists():
        return []
    own = path.removesuffix(".cpp") + ".h"
    for number, line in enumerate(text.splitlines(), start=1):
        include = INCLUDE.match(line)
        if include:
            return [] if include.group(2) == own else [Problem(path, number, f'must include "{own}" first')]
    return [Problem(path, 1, f'must include "{own}" first')]


def check_link_lines(path, text):
    """Checks that a CMakeLists.txt links only what its folder may include."""
    layer = layer_of(path)
    if layer is None:
        return []
    problems = []
    for number, line in enumerate(text.splitlines(), start=1):
        for name in re.findall(r"floorloc::(\w+)", line.partition("#")[0]):
            folder = TARGETS.get(name, name)
            if not any(target == folder or target.endswith("/" + folder) for target in reachable(layer)):
                problems.append(Problem(path, number, f"{layer} must not link floorloc::{name}"))
    return problems


def check_tree(root):
    problems = []
    for folder in sorted(root.rglob("*")):
        relative = folder.relative_to(root)
        if folder.is_dir() and folder.name in FORBIDDEN_FOLDERS and not NOT_OURS & set(relative.parts):
            problems.append(Problem(str(relative), 1, "name a folder after what it does, not 'util'"))
    for file in sorted(file for part in PRODUCT for file in (root / part).rglob("*")):
        path = file.relative_to(root).as_posix()
        if file.suffix in {".h", ".cpp"}:
            problems += check_source(path, file.read_text())
            problems += check_own_header(file, path, file.read_text())
        elif file.name == "CMakeLists.txt":
            problems += check_link_lines(path, file.read_text())
    return problems


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2])
    problems = check_tree(root)
    for problem in problems:
        print(problem)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
