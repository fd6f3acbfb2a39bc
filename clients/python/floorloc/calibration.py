# SPDX-License-Identifier: Apache-2.0
"""What a vehicle tells the server of its camera, from the files of a survey folder."""

from __future__ import annotations

import base64
import json
import pathlib
import re
from typing import Any, Dict, List, Tuple, Union

from .types import Calibration


def read_calibration(folder: Union[str, pathlib.Path]) -> Calibration:
    """camera, floor and, where there is one, mask of a folder with camera.yaml, floor.yaml and mask.png."""
    folder = pathlib.Path(folder)
    calibration: Calibration = {
        "camera": read_yaml(folder / "camera.yaml"),  # type: ignore[typeddict-item]
        "floor": read_yaml(folder / "floor.yaml"),  # type: ignore[typeddict-item]
    }
    if (folder / "mask.png").exists():
        calibration["mask"] = base64.b64encode((folder / "mask.png").read_bytes()).decode()
    return calibration


def read_yaml(file: pathlib.Path) -> Dict[str, Any]:
    """Parses the subset of YAML that camera.yaml and floor.yaml use: nested keys, [lists], {maps}, comments."""
    text = re.sub(r"(^|\s)#.*", "", file.read_text(encoding="utf-8"))
    text = re.sub(r"\[[^\]]*\]", lambda brackets: " ".join(brackets[0].split()), text)
    root: Dict[str, Any] = {}
    parents: List[Tuple[int, Dict[str, Any]]] = [(-1, root)]  # (indentation, mapping)
    for line in text.splitlines():
        key, colon, value = line.strip().partition(":")
        if line.strip().startswith("- "):
            raise ValueError(f"{file}: write lists in brackets, [1, 2, 3]")
        if not colon:
            continue
        indentation = len(line) - len(line.lstrip())
        while indentation <= parents[-1][0]:
            parents.pop()
        parent = parents[-1][1]
        if value.strip():
            parent[key] = parse_scalar(value.strip())
        else:
            parent[key] = {}
            parents.append((indentation, parent[key]))
    return root


def parse_scalar(text: str) -> Any:
    try:
        return json.loads(re.sub(r"([A-Za-z_]\w*)\s*:", r'"\1":', text))
    except ValueError:
        return text.strip("'\"")
