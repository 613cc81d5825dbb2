"""Types of the compiled module; `help` has its documentation."""

from os import PathLike
from typing import Literal, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Axis = Literal["y", "z"]
Engine = Literal["fast", "machine", "rays"]
Coverage = Literal["exact", "alpha", "center", "any"]
Cage = Literal["frame", "corners"]

__version__: str

class Error(Exception):
    exit_code: int

class Scene:
    @staticmethod
    def open(
        path: str | PathLike[str],
        *,
        depth: int = 9,
        opacities: bool = False,
        up: Axis | None = None,
        verify: bool = False,
        voxel_size: float | None = None,
    ) -> Scene: ...
    @staticmethod
    def generate(specification: str) -> Scene: ...
    @staticmethod
    def from_numpy(indices: ArrayLike, colors: ArrayLike | None = None, *, up: Axis = "z") -> Scene: ...
    @staticmethod
    def from_mesh(
        positions: ArrayLike,
        triangles: ArrayLike,
        colors: ArrayLike | None = None,
        *,
        depth: int = 9,
        opacities: bool = False,
        up: Axis | None = None,
    ) -> Scene: ...
    def crop(
        self,
        *,
        x: tuple[int | None, int | None] | None = None,
        y: tuple[int | None, int | None] | None = None,
        z: tuple[int | None, int | None] | None = None,
    ) -> Scene: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def to_numpy(self) -> tuple[NDArray[np.int32], NDArray[np.uint8]]: ...
    @property
    def voxels(self) -> int: ...
    @property
    def depth(self) -> int: ...
    @property
    def bytes(self) -> int: ...
    @property
    def bounds(self) -> list[list[float]]: ...
    @property
    def is_verified(self) -> bool: ...
    @property
    def warnings(self) -> list[str]: ...

class Camera:
    @staticmethod
    def fit(
        scene: Scene,
        *,
        azimuth: float | None = None,
        elevation: float | None = None,
        zoom: float = 1.0,
        fov: float | None = None,
        ortho: bool = False,
    ) -> Camera: ...
    @staticmethod
    def look_at(
        eye: Sequence[float],
        target: Sequence[float],
        up: Sequence[float] | None = None,
        fov: float | None = None,
        ortho: float | None = None,
    ) -> Camera: ...
    def placed(self, size: int | Sequence[int]) -> Camera: ...
    @property
    def eye(self) -> list[float]: ...
    @property
    def target(self) -> list[float]: ...
    @property
    def up(self) -> list[float]: ...
    @property
    def fov(self) -> float | None: ...
    @property
    def ortho(self) -> float | None: ...

class Picture:
    rgba: NDArray[np.uint8]
    depth: NDArray[np.float32]
    normals: NDArray[np.float32]
    voxels: NDArray[np.int32]
    nodes: NDArray[np.int32]
    counters: dict[str, int]
    hash: str | None
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    def save_png(self, path: str | PathLike[str]) -> None: ...

def render(
    scene: Scene,
    camera: Camera | None = None,
    size: int | Sequence[int] | None = None,
    *,
    samples: int = 1,
    engine: Engine = "fast",
    coverage: Coverage | None = None,
    lod: float | None = None,
    tolerance: float | None = None,
    cage: Cage | None = None,
    bits: int = 64,
    frac: int | None = None,
    paper: bool = False,
    shaded: bool = True,
    background: Sequence[int] | None = None,
    transparent: bool = False,
    threads: int = 0,
    buffers: Sequence[Literal["depth", "normals", "voxels", "nodes"]] | None = None,
) -> Picture: ...

def documents(words: Sequence[str]) -> str: ...
