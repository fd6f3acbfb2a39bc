# SPDX-License-Identifier: Apache-2.0
"""Maps. Named as the schemas of schema/openapi.yaml."""

from __future__ import annotations

from typing import Any, Dict, List, Literal, Optional, TypedDict

from .requests import Camera, Floor, Rectangle


class Layer(TypedDict):
    name: str
    extractor: str
    keypoints: int


class Mosaic(TypedDict):
    tile_px: int
    max_zoom: int
    resolution: float


class RefusedFile(TypedDict):
    code: Literal["map_damaged", "map_unsupported", "map_unavailable"]
    error: str


class _MapSummaryRequired(TypedDict):
    name: str
    status: Literal["ready", "error"]


class MapSummary(_MapSummaryRequired, total=False):
    code: Literal["map_damaged", "map_unsupported", "map_unavailable"]
    error: str
    refused_file: RefusedFile
    id: str
    version: str
    created: str
    builder_version: str
    frame: Literal["map"]
    resolution: float
    extent: Rectangle
    area_m2: float
    layers: List[Layer]
    mosaic: Mosaic


class MapList(TypedDict):
    maps: List[MapSummary]


class Version(TypedDict):
    version: str
    active: bool
    id: str
    created: str
    builder_version: str
    parents: List[str]
    area_m2: float
    bytes: int
    added: float
    origin: Literal["upload", "folder", "recovered"]


class Scale(TypedDict):
    sigma: float
    sources: List[str]


class FloorLattice(TypedDict):
    basis: List[List[float]]
    point: List[float]
    residual_m: float
    share: float
    floor_share: float
    extent: Rectangle


class _MapRequired(TypedDict):
    name: str
    status: Literal["ready", "error"]
    versions: List[Version]


class Map(_MapRequired, total=False):
    code: Literal["map_damaged", "map_unsupported", "map_unavailable"]
    error: str
    refused_file: RefusedFile
    id: str
    version: str
    created: str
    builder_version: str
    frame: Literal["map"]
    resolution: float
    extent: Rectangle
    area_m2: float
    layers: List[Layer]
    mosaic: Mosaic
    scale: Scale
    lattice: Optional[FloorLattice]
    format_version: int
    extractor: Dict[str, Any]
    camera: Camera
    floor: Floor


class SuccessSquare(TypedDict):
    x: float
    y: float
    found: int
    missed: int
    inliers: float
    survey_again: bool


class MapSuccess(TypedDict):
    map: str
    map_version: str
    since: Optional[float]
    cell_m: float
    unplaced: int
    cells: List[SuccessSquare]
