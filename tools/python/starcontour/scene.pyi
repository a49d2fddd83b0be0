# Types of scenes; see scene.py.
#
# SPDX-License-Identifier: MIT
from typing import Iterator, List, Literal, NamedTuple, Optional, Tuple

import numpy as np
import numpy.typing as npt

from . import Model

class Meeting(NamedTuple):
    a: SceneObject
    b: SceneObject
    pairs: npt.NDArray[np.uint32]
    times: Optional[npt.NDArray[np.float64]]

class SceneNear(NamedTuple):
    vertex_faces: List[Meeting]
    edge_edges: List[Meeting]

class SceneStep(NamedTuple):
    vertex_faces: List[Meeting]
    edge_edges: List[Meeting]
    earliest: float

class SceneObject:
    scene: Scene
    number: int
    model: Model
    itself: bool
    group: Optional[Tuple[int, int]]
    @property
    def pose(self) -> Optional[npt.NDArray[np.floating]]: ...
    @pose.setter
    def pose(self, positions: npt.ArrayLike) -> None: ...
    @property
    def end(self) -> Optional[npt.NDArray[np.floating]]: ...
    @end.setter
    def end(self, positions: Optional[npt.ArrayLike]) -> None: ...

class Scene:
    objects: List[SceneObject]
    def __init__(self) -> None: ...
    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[SceneObject]: ...
    def add(
        self,
        model: Model,
        pose: Optional[npt.ArrayLike] = None,
        *,
        itself: bool = True,
        group: Optional[Tuple[int, int]] = None,
        ignore_rings: int = 0,
        rest: Optional[npt.ArrayLike] = None,
        rest_distance: float = 0.0,
    ) -> SceneObject: ...
    def query(
        self,
        *,
        pairs: Literal["triangle", "edge"] = "triangle",
        contact: Literal["touching", "proper"] = "touching",
        method: Literal["default", "sctt", "aabb_sctt", "aabb"] = "default",
        cancel: Optional[npt.NDArray[np.uint32]] = None,
        threads: int = 1,
    ) -> List[Meeting]: ...
    def near(
        self,
        distance: float,
        *,
        kinds: Literal["both", "vertex_face", "edge_edge"] = "both",
        method: Literal["default", "sctt", "boxes"] = "default",
        cancel: Optional[npt.NDArray[np.uint32]] = None,
        threads: int = 1,
    ) -> SceneNear: ...
    def step(
        self,
        *,
        separation: float = 0.0,
        tolerance: float = 0.0,
        method: Literal["default", "sctt", "two_boxes", "swept"] = "default",
        only_nearer: bool = False,
        cancel: Optional[npt.NDArray[np.uint32]] = None,
        threads: int = 1,
    ) -> SceneStep: ...
