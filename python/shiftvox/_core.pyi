"""What the compiled module has."""

from os import PathLike
from typing import Literal, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Axis = Literal["y", "z"]
Engine = Literal["fast", "machine", "rays"]
Coverage = Literal["exact", "alpha", "center", "any"]
Cage = Literal["frame", "corners"]

class Error(Exception):
    """What shiftvox refuses or cannot do, in the words of the program. Errors of `run`, `model`, `hardware` and
    `explore` have an `exit_code`: what the program would have ended with."""

    exit_code: int
    """What the program would have ended with; only on errors of `run`, `model` and `explore`."""

class Scene:
    """A graph of voxels. World units are those of the file; a voxel of index i fills [i, i + 1) along each axis
    unless the file says another size and place. Cannot be pickled: give other processes the name of a file."""

    @staticmethod
    def open(path: str | PathLike[str], *, depth: int = 9, opacities: bool = False, up: Axis | None = None) -> Scene:
        """Open a voxel file, a voxel graph or a mesh; spec/input.md and spec/mesh.md list the formats. A mesh is
        voxelised with 2**depth voxels along its longest side, depth 1 to 20. `opacities`: as `coverage="alpha"`
        blends them. `up`: another axis than the format's custom.

        Raises `Error` where the file is missing, damaged, unknown or too large.
        """
    @staticmethod
    def generate(specification: str) -> Scene:
        """A generated scene, such as "terrain,depth=7,seed=1"; spec/generators.md lists them.

        Raises `Error` where no generator has the name, or a parameter is wrong.
        """
    @staticmethod
    def from_numpy(indices: ArrayLike, colors: ArrayLike | None = None, *, up: Axis = "z") -> Scene:
        """A scene of voxels: indices (N, 3), any integers of 32 bits, and colours (N, 3), integers 0 to 255 in
        sRGB; grey without. Of rows with the same index the last one counts.

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
        """A mesh, voxelised as `open` does it: positions (V, 3), any numbers; triangles (T, 3), integers: rows of
        positions; colours (V, 3), integers 0 to 255 in sRGB; grey without.

        Raises `Error` for other shapes and numbers, for no triangles, and for a corner that is no row of positions.
        """
    def save(self, path: str | PathLike[str]) -> None:
        """Write a .vxg file, replacing what is there. Raises `Error` where the system refuses."""
    @property
    def voxels(self) -> int:
        """Voxels of the finest level."""
    @property
    def depth(self) -> int:
        """Levels below the root: the cube around the voxels has 2**depth of them a side."""
    @property
    def bytes(self) -> int:
        """Bytes of the graph, in memory or in the file that it is mapped from."""
    @property
    def bounds(self) -> list[list[float]]:
        """The lowest and the highest corner of the voxels, world units."""

class Camera:
    """Where a scene is seen from. Cannot be pickled: make it where it is used."""

    @staticmethod
    def fit(
        scene: Scene,
        *,
        azimuth: float | None = None,
        elevation: float | None = None,
        zoom: float = 1.0,
        fov: float | None = None,
    ) -> Camera:
        """A camera that sees all of a scene. Angles in degrees: azimuth around the up axis (0 the front, 90 the
        right), elevation above the horizon, fov the vertical field of view. zoom: magnification, above 0.

        `render` raises `Error` for a zoom or a field of view that is out of range.
        """
    @staticmethod
    def look_at(
        eye: Sequence[float], target: Sequence[float], *, up: Sequence[float] | None = None, fov: float | None = None
    ) -> Camera:
        """A camera at `eye` that has `target` in the middle; three numbers each, world units. up: a direction, (0,
        0, 1) unless given. fov: the vertical field of view, degrees.

        `render` raises `Error` where eye and target are one, and for an up along the view.
        """

class Picture:
    """A finished picture. The arrays are its buffers: nothing is copied, and each access gives the same array.
    Cannot be pickled; its arrays can."""

    rgba: NDArray[np.uint8]
    """uint8 (height, width, 4): red, green, blue in sRGB, and alpha, not premultiplied."""
    depth: NDArray[np.float32]
    """float32 (height, width): along the view axis, world units; infinity where nothing is seen."""
    normals: NDArray[np.float32]
    """float32 (height, width, 3): unit length, world directions; zero where nothing is seen."""
    voxels: NDArray[np.int32]
    """int32 (height, width, 4): index of the voxel seen, and its level (0 the root); (0, 0, 0, -1) where nothing
    is."""
    nodes: NDArray[np.int32]
    """int32 (height, width): the node of the graph seen; -1 where nothing is."""
    counters: dict[str, int]
    """What the engine counted, by name."""
    hash: str | None
    """Of all buffers as they were drawn: 32 hexadecimal digits, the same on every computer. None unless all buffers
    were requested."""
    @property
    def width(self) -> int:
        """Pixels across."""
    @property
    def height(self) -> int:
        """Pixels down."""
    def save_png(self, path: str | PathLike[str]) -> None:
        """Write the colours as a PNG, replacing what is there. Raises `Error` where the system refuses."""

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
    """Draw a scene, by default with a fitted camera, 512 x 512. Other Python threads run meanwhile.

    size: pixels, one number or (width, height). samples: 1, 2 or 4 along each axis of a pixel. engine: "fast",
    "machine" (the counted words of the hardware) or "rays" (the oracle). coverage: "exact" (the default), "alpha",
    "center" or "any". lod: size in pixels up to which nodes are drawn as one voxel. tolerance: pixels, of the
    coverages center and any. cage: "frame" (the default) or "corners". bits, frac: width of a word, 16 to 64, and
    its fraction. paper: the rules of the image-order paper, which set coverage, tolerance and cage. background:
    three numbers, 0 to 255 in sRGB; or transparent, not both. threads: up to 1024, 0 for all; never changes the
    picture. buffers: those to compute besides the colours, of "depth", "normals", "voxels" and "nodes"; all unless
    given. A picture has None for the others.

    Raises `Error` for settings that are out of range or exclude each other, and where a word overflows.
    """

def documents(words: Sequence[str]) -> str:
    """What the program prints for a command line with --json. The `exit_code` of an `Error` is the program's."""
