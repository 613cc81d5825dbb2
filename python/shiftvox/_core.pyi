"""The compiled module."""

from os import PathLike
from typing import Literal, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Axis = Literal["y", "z"]
Engine = Literal["fast", "machine", "rays"]
Coverage = Literal["exact", "alpha", "center", "any"]
Cage = Literal["frame", "corners"]

class Error(Exception):
    """An error with the program's message. Errors of `run`, `model`, `hardware` and `explore` have its `exit_code`."""

    exit_code: int
    """Only on errors of `run`, `model`, `hardware` and `explore`."""

class Scene:
    """A graph of voxels. World units are those of the file. A voxel of index i fills [i, i + 1) along each axis,
    unless the file sets another size and place. Cannot be pickled: pass the name of a file to other processes."""

    @staticmethod
    def open(path: str | PathLike[str], *, depth: int = 9, opacities: bool = False, up: Axis | None = None) -> Scene:
        """Open a voxel file, a voxel graph or a mesh; spec/input.md and spec/mesh.md list the formats. A mesh is
        voxelised with 2**depth voxels along its longest side, depth 1 to 20. `opacities`: for `coverage="alpha"`.
        `up`: the up axis, by default the format's.

        Raises `Error` for a file that is missing, damaged, unknown or too large.
        """
    @staticmethod
    def generate(specification: str) -> Scene:
        """A generated scene, such as "terrain,depth=7,seed=1"; spec/generators.md lists them.

        Raises `Error` for an unknown generator or a wrong parameter.
        """
    @staticmethod
    def from_numpy(indices: ArrayLike, colors: ArrayLike | None = None, *, up: Axis = "z") -> Scene:
        """A scene of voxels. Indices (N, 3) are 32-bit integers, and colours (N, 3) are integers 0 to 255 in sRGB, by
        default grey. Of rows with the same index the last counts.

        Raises `Error` for other shapes and numbers, for no rows, and for voxels more than 2**21 apart.
        """
    @staticmethod
    def from_mesh(
        positions: ArrayLike,
        triangles: ArrayLike,
        colors: ArrayLike | None = None,
        *,
        depth: int = 9,
        opacities: bool = False,
        up: Axis | None = None,
    ) -> Scene:
        """A mesh, voxelised as by `open`. Positions (V, 3) are any numbers, triangles (T, 3) rows of positions, and
        colours (V, 3) integers 0 to 255 in sRGB, by default grey.

        Raises `Error` for other shapes and numbers, for no triangles, and for a corner that is not a row of positions.
        """
    def save(self, path: str | PathLike[str]) -> None:
        """Write a .vxg file, replacing an existing one. Raises `Error` if the system refuses."""
    @property
    def voxels(self) -> int:
        """Voxels of the finest level."""
    @property
    def depth(self) -> int:
        """Levels below the root: the cube around the voxels has 2**depth voxels per side."""
    @property
    def bytes(self) -> int:
        """Bytes of the graph, in memory or in its mapped file."""
    @property
    def bounds(self) -> list[list[float]]:
        """The lowest and the highest corner of the voxels, world units."""

class Camera:
    """A view of a scene. Cannot be pickled: make it where it is used."""

    @staticmethod
    def fit(
        scene: Scene,
        *,
        azimuth: float | None = None,
        elevation: float | None = None,
        zoom: float = 1.0,
        fov: float | None = None,
    ) -> Camera:
        """A camera that sees the whole scene. Angles are in degrees: azimuth around the up axis (0 front, 90 right),
        elevation above the horizon, vertical field of view (fov). The magnification `zoom` is above 0.

        `render` raises `Error` for a zoom or field of view out of range.
        """
    @staticmethod
    def look_at(
        eye: Sequence[float], target: Sequence[float], *, up: Sequence[float] | None = None, fov: float | None = None
    ) -> Camera:
        """A camera at `eye`, aimed at `target`, three numbers each, world units. The direction `up` is (0, 0, 1) by
        default, and `fov` the vertical field of view in degrees.

        `render` raises `Error` if eye and target coincide, or up is parallel to the view.
        """

class Picture:
    """A finished picture. The arrays are its buffers, without copies; each access returns the same array. Cannot be
    pickled; its arrays can."""

    rgba: NDArray[np.uint8]
    """uint8 (height, width, 4): red, green, blue in sRGB, and alpha, not premultiplied."""
    depth: NDArray[np.float32]
    """float32 (height, width), along the view axis, world units. Infinity for background."""
    normals: NDArray[np.float32]
    """float32 (height, width, 3), unit length, world directions. Zero for background."""
    voxels: NDArray[np.int32]
    """int32 (height, width, 4): index of the visible voxel, and its level (0 the root). (0, 0, 0, -1) for
    background."""
    nodes: NDArray[np.int32]
    """int32 (height, width): the visible node of the graph. -1 for background."""
    counters: dict[str, int]
    """Counters of the engine, by name."""
    hash: str | None
    """Hash of all buffers as drawn: 32 hexadecimal digits, the same on every computer. None unless all buffers were
    requested."""
    @property
    def width(self) -> int:
        """Pixels across."""
    @property
    def height(self) -> int:
        """Pixels down."""
    def save_png(self, path: str | PathLike[str]) -> None:
        """Write the colours as a PNG, replacing an existing file. Raises `Error` if the system refuses."""

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
) -> Picture:
    """Draw a scene, by default with a fitted camera at 512 x 512 pixels. Other Python threads run meanwhile.

    - size: pixels, one number or (width, height).
    - samples: 1, 2 or 4 along each axis of a pixel.
    - engine: "fast", "machine" (counts operations in the hardware's words) or "rays" (the oracle).
    - coverage: "exact" (default), "alpha", "center" or "any".
    - lod: size in pixels up to which nodes are drawn as one voxel.
    - tolerance: pixels, for coverages center and any.
    - cage: "frame" (default) or "corners".
    - bits, frac: width of a word, 16 to 64, and its fraction.
    - paper: the rules of the image-order paper, which set coverage, tolerance and cage.
    - background: three numbers, 0 to 255 in sRGB; excludes transparent.
    - threads: up to 1024, 0 for all; the picture is the same.
    - buffers: of "depth", "normals", "voxels" and "nodes", by default all. Others are None in the picture.

    Raises `Error` for settings out of range or in conflict, and for overflow of a word.
    """

def documents(words: Sequence[str]) -> str:
    """The program's output for a command line with --json. An `Error` has the program's `exit_code`."""
