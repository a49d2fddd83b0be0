# Types of the package, and the keywords of each method in full; see __init__.py.
#
# SPDX-License-Identifier: MIT
import os
from types import TracebackType
from typing import Any, List, Literal, NamedTuple, Optional, Sequence, Tuple, Type, TypeVar, Union

import numpy as np
import numpy.typing as npt

from .scene import Meeting, Scene, SceneNear, SceneObject, SceneStep

__all__ = ["Error", "Incomplete", "Meeting", "Model", "ModelInfo", "Near", "Scene", "SceneNear",
           "SceneObject", "SceneStep", "Step", "Workspace", "edge_vertices", "merge_stencils", "version"]

version: str

_Self = TypeVar("_Self", bound=_Queries)
_Pairs = npt.NDArray[np.uint32]
_Times = npt.NDArray[np.float64]
_Structured = npt.NDArray[np.void]
_Flag = npt.NDArray[np.uint32]

class ModelInfo(NamedTuple):
    vertex_count: int
    point_count: int
    triangle_count: int
    edge_count: int
    component_count: int
    boundary_edges: int
    irregular_edges: int
    leaf_count: int
    level_count: int
    node_count: int
    segment_count: int
    topology_hash: int
    model_bytes: int
    workspace_bytes: int
    peak_bytes: int
    allocations: int

class Step(NamedTuple):
    vertex_faces: _Pairs
    edge_edges: _Pairs
    vertex_face_times: Optional[_Times]
    edge_edge_times: Optional[_Times]
    earliest: float

class Trace(NamedTuple):
    nodes: _Structured
    contours: _Structured
    def polylines(self) -> List[npt.NDArray[np.float64]]: ...

class Regions(NamedTuple):
    regions: _Structured
    vertex_regions: npt.NDArray[np.uint32]
    sides: npt.NDArray[np.uint32]

class Near(NamedTuple):
    vertex_faces: _Pairs
    edge_edges: _Pairs
    vertex_face_stencils: Optional[_Structured]
    edge_edge_stencils: Optional[_Structured]
    vertex_bound: Optional[npt.NDArray[np.float64]]

class Error(Exception):
    status: int
    def __init__(self, status: int, text: Optional[str] = None) -> None: ...

class Incomplete(Error):
    found: Any
    def __init__(self, found: Any) -> None: ...

def merge_stencils(*stencils: _Structured) -> Tuple[_Structured, npt.NDArray[np.uint32]]: ...
def edge_vertices(triangles: npt.ArrayLike, edges: npt.ArrayLike) -> npt.NDArray[Any]: ...

class _Queries:
    def __enter__(self: _Self) -> _Self: ...
    def __exit__(
        self,
        kind: Optional[Type[BaseException]],
        value: Optional[BaseException],
        trace: Optional[TracebackType],
    ) -> None: ...
    def query(
        self,
        pose: npt.ArrayLike,
        *,
        pairs: Literal["triangle", "edge"] = "triangle",
        contact: Literal["touching", "proper"] = "touching",
        method: Literal["default", "sctt", "aabb_sctt", "aabb"] = "default",
        rest_cache: bool = True,
        ignore_rings: int = 0,
        ignore: Optional[npt.ArrayLike] = None,
        vertex_groups: Optional[npt.ArrayLike] = None,
        triangle_groups: Optional[npt.ArrayLike] = None,
        cancel: Optional[_Flag] = None,
        budget: int = 0,
        threads: int = 1,
    ) -> _Pairs: ...
    def count(
        self,
        pose: npt.ArrayLike,
        *,
        pairs: Literal["triangle", "edge"] = "triangle",
        contact: Literal["touching", "proper"] = "touching",
        method: Literal["default", "sctt", "aabb_sctt", "aabb"] = "default",
        rest_cache: bool = True,
        ignore_rings: int = 0,
        ignore: Optional[npt.ArrayLike] = None,
        vertex_groups: Optional[npt.ArrayLike] = None,
        triangle_groups: Optional[npt.ArrayLike] = None,
        cancel: Optional[_Flag] = None,
        budget: int = 0,
        threads: int = 1,
    ) -> int: ...
    def collides(
        self,
        pose: npt.ArrayLike,
        *,
        pairs: Literal["triangle", "edge"] = "triangle",
        contact: Literal["touching", "proper"] = "touching",
        method: Literal["default", "sctt", "aabb_sctt", "aabb"] = "default",
        rest_cache: bool = True,
        ignore_rings: int = 0,
        ignore: Optional[npt.ArrayLike] = None,
        vertex_groups: Optional[npt.ArrayLike] = None,
        triangle_groups: Optional[npt.ArrayLike] = None,
        cancel: Optional[_Flag] = None,
        budget: int = 0,
        threads: int = 1,
    ) -> bool: ...
    def step(
        self,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        *,
        separation: float = 0.0,
        tolerance: float = 0.0,
        method: Literal["default", "sctt", "two_boxes", "swept"] = "default",
        candidates: bool = False,
        only_nearer: bool = False,
        ignore_rings: int = 0,
        ignore: Union[Step, Near, Sequence[npt.ArrayLike], None] = None,
        vertex_groups: Optional[npt.ArrayLike] = None,
        triangle_groups: Optional[npt.ArrayLike] = None,
        rest: Optional[npt.ArrayLike] = None,
        rest_distance: float = 0.0,
        cancel: Optional[_Flag] = None,
        budget: int = 0,
        threads: int = 1,
    ) -> Step: ...
    def step_collides(
        self,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        *,
        separation: float = 0.0,
        tolerance: float = 0.0,
        method: Literal["default", "sctt", "two_boxes", "swept"] = "default",
        candidates: bool = False,
        only_nearer: bool = False,
        ignore_rings: int = 0,
        ignore: Union[Step, Near, Sequence[npt.ArrayLike], None] = None,
        vertex_groups: Optional[npt.ArrayLike] = None,
        triangle_groups: Optional[npt.ArrayLike] = None,
        rest: Optional[npt.ArrayLike] = None,
        rest_distance: float = 0.0,
        cancel: Optional[_Flag] = None,
        budget: int = 0,
        threads: int = 1,
    ) -> bool: ...
    def near(
        self,
        pose: npt.ArrayLike,
        distance: float,
        *,
        stencils: bool = False,
        vertex_bound: bool = False,
        kinds: Literal["both", "vertex_face", "edge_edge"] = "both",
        method: Literal["default", "sctt", "boxes"] = "default",
        ignore_rings: int = 0,
        ignore: Union[Step, Near, Sequence[npt.ArrayLike], None] = None,
        vertex_groups: Optional[npt.ArrayLike] = None,
        triangle_groups: Optional[npt.ArrayLike] = None,
        rest: Optional[npt.ArrayLike] = None,
        rest_distance: float = 0.0,
        cancel: Optional[_Flag] = None,
        budget: int = 0,
        threads: int = 1,
    ) -> Near: ...
    def near_counts(
        self,
        pose: npt.ArrayLike,
        distance: float,
        *,
        kinds: Literal["both", "vertex_face", "edge_edge"] = "both",
        method: Literal["default", "sctt", "boxes"] = "default",
        ignore_rings: int = 0,
        ignore: Union[Step, Near, Sequence[npt.ArrayLike], None] = None,
        vertex_groups: Optional[npt.ArrayLike] = None,
        triangle_groups: Optional[npt.ArrayLike] = None,
        rest: Optional[npt.ArrayLike] = None,
        rest_distance: float = 0.0,
        cancel: Optional[_Flag] = None,
        budget: int = 0,
        threads: int = 1,
    ) -> Tuple[int, int]: ...
    def is_near(
        self,
        pose: npt.ArrayLike,
        distance: float,
        *,
        kinds: Literal["both", "vertex_face", "edge_edge"] = "both",
        method: Literal["default", "sctt", "boxes"] = "default",
        ignore_rings: int = 0,
        ignore: Union[Step, Near, Sequence[npt.ArrayLike], None] = None,
        vertex_groups: Optional[npt.ArrayLike] = None,
        triangle_groups: Optional[npt.ArrayLike] = None,
        rest: Optional[npt.ArrayLike] = None,
        rest_distance: float = 0.0,
        cancel: Optional[_Flag] = None,
        budget: int = 0,
        threads: int = 1,
    ) -> bool: ...

class Workspace(_Queries):
    model: Model
    def __init__(self, model: Model) -> None: ...
    def close(self) -> None: ...

class Model(_Queries):
    def __init__(
        self,
        vertices: npt.ArrayLike,
        triangles: npt.ArrayLike,
        *,
        weld: Union[Literal["rest", "none"], npt.ArrayLike] = "rest",
        order: Optional[npt.ArrayLike] = None,
        boxes: bool = False,
        threads: int = 1,
    ) -> None: ...
    @classmethod
    def frombytes(cls, data: Any, *, topology_hash: int = 0, in_place: bool = False) -> Model: ...
    @classmethod
    def load(
        cls, path: Union[str, os.PathLike[str]], *, topology_hash: int = 0, in_place: bool = False
    ) -> Model: ...
    def tobytes(self) -> bytes: ...
    def save(self, path: Union[str, os.PathLike[str]]) -> None: ...
    @property
    def info(self) -> ModelInfo: ...
    def patches(self, level: int) -> npt.NDArray[np.uint32]: ...
    def contacts(
        self,
        pose: npt.ArrayLike,
        found: npt.ArrayLike,
        *,
        pairs: Literal["triangle", "edge"] = "triangle",
    ) -> _Structured: ...
    def trace(
        self, pose: npt.ArrayLike, found: Optional[npt.ArrayLike] = None, *, threads: int = 1
    ) -> Trace: ...
    def trace_triples(
        self, pose: npt.ArrayLike, traced: Optional[Trace] = None
    ) -> _Structured: ...
    def regions(
        self, pose: npt.ArrayLike, traced: Optional[Trace] = None, *, inside: bool = False
    ) -> Regions: ...
    def trace_gradients(self, pose: npt.ArrayLike, traced: Trace) -> _Structured: ...
    def trace_length(
        self, pose: npt.ArrayLike, found: Optional[npt.ArrayLike] = None, *, threads: int = 1
    ) -> Tuple[float, npt.NDArray[np.float64]]: ...
    def stencils(
        self,
        pose: npt.ArrayLike,
        found: npt.ArrayLike,
        *,
        kind: Literal["vertex_face", "edge_edge"],
    ) -> _Structured: ...
    def step_stencils(
        self,
        start: npt.ArrayLike,
        end: npt.ArrayLike,
        found: npt.ArrayLike,
        times: Optional[npt.ArrayLike] = None,
        *,
        kind: Literal["vertex_face", "edge_edge"],
    ) -> _Structured: ...
    def workspace(self) -> Workspace: ...
    def close(self) -> None: ...
