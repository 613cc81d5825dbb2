"""What the compiled module has."""

from os import PathLike
from typing import Literal, Sequence

import numpy as np
from numpy.typing import NDArray

Axis = Literal["y", "z"]
Engine = Literal["fast", "machine", "rays"]
Coverage = Literal["exact", "alpha", "center", "any"]
Cage = Literal["frame", "corners"]
Place = tuple[float, float, float]

class Error(Exception):
    """What shiftvox refuses or cannot do, in the words of the program."""

    exit_code: int
    """What the program would have ended with; only on errors of `run`, `model` and `explore`."""

class Scene:
    """A graph of voxels. World units are those of the file; a voxel of index i fills [i, i + 1) along each axis
    unless the file says another size and place."""

    @staticmethod
    def open(path: str | PathLike[str], *, depth: int = 9, opacities: bool = False, up: Axis | None = None) -> Scene:
        """Open a voxel file (.vox, .ply, .npy, .vxg) or a mesh (.obj, .ply, .stl, .gltf, .glb), which is voxelised
        with 2**depth voxels along its longest side. `opacities`: as `coverage="alpha"` blends them."""
    @staticmethod
    def generate(specification: str) -> Scene:
        """A generated scene, such as "terrain,depth=7,seed=1"; spec/generators.md lists them."""
    @staticmethod
    def from_numpy(indices: NDArray[np.int32], colors: NDArray[np.uint8] | None = None, *, up: Axis = "z") -> Scene:
        """A scene of voxels: indices (N, 3), and colours (N, 3) in sRGB; grey without."""
    @staticmethod
    def from_mesh(
        positions: NDArray[np.float64],
        triangles: NDArray[np.int64],
        colors: NDArray[np.uint8] | None = None,
        *,
        depth: int = 9,
        opacities: bool = False,
        up: Axis | None = None,
    ) -> Scene:
        """A mesh, voxelised: positions (V, 3), triangles (T, 3) as rows of positions, colours (V, 3) in sRGB."""
    def save(self, path: str | PathLike[str]) -> None:
        """Write a .vxg file, replacing what is there."""
    @property
    def voxels(self) -> int: ...
    @property
    def depth(self) -> int:
        """Levels below the root."""
    @property
    def bytes(self) -> int:
        """Bytes in memory."""
    @property
    def bounds(self) -> list[list[float]]:
        """The lowest and the highest corner of the voxels, world units."""

class Camera:
    """Where a scene is seen from."""

    @staticmethod
    def fit(
        scene: Scene,
        *,
        azimuth: float | None = None,
        elevation: float | None = None,
        zoom: float = 1.0,
        fov: float | None = None,
    ) -> Camera:
        """A camera that sees all of a scene. Angles in degrees."""
    @staticmethod
    def look_at(
        eye: Sequence[float], target: Sequence[float], *, up: Sequence[float] | None = None, fov: float | None = None
    ) -> Camera:
        """A camera at `eye` that has `target` in the middle; world units, `fov` in degrees."""

class Picture:
    """A finished picture. The arrays are its buffers: nothing is copied, and each access gives the same array."""

    rgba: NDArray[np.uint8]
    """(height, width, 4), sRGB, alpha not premultiplied."""
    depth: NDArray[np.float32]
    """(height, width), along the view axis, world units; infinity where nothing is seen."""
    normals: NDArray[np.float32]
    """(height, width, 3), unit length, world directions; zero where nothing is seen."""
    voxels: NDArray[np.int32]
    """(height, width, 4): index of the voxel seen, and its level (0 the root); (0, 0, 0, -1) where nothing is."""
    nodes: NDArray[np.int32]
    """(height, width): the node of the graph seen; -1 where nothing is."""
    counters: dict[str, int]
    """What the engine counted."""
    hash: str
    """Of all buffers as they were drawn: 32 hexadecimal digits, the same on every computer."""
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    def save_png(self, path: str | PathLike[str]) -> None:
        """Write the colours, replacing what is there."""

def render(
    scene: Scene,
    camera: Camera | None = None,
    size: int | tuple[int, int] | None = None,
    *,
    samples: int = 1,
    engine: Engine = "fast",
    coverage: Coverage = "exact",
    lod: float | None = None,
    tolerance: float | None = None,
    cage: Cage = "frame",
    bits: int = 64,
    frac: int | None = None,
    paper: bool = False,
    shaded: bool = True,
    background: tuple[int, int, int] | None = None,
    transparent: bool = False,
    threads: int = 0,
) -> Picture:
    """Draw a scene, by default with a fitted camera, 512 x 512. Other Python threads run meanwhile.

    samples: 1, 2 or 4 along each axis of a pixel. lod: size in pixels up to which nodes are drawn as one voxel.
    tolerance: pixels, of the coverages center and any. paper: the rules of the image-order paper. threads: 0 for
    all; never changes the picture.
    """

def documents(words: Sequence[str]) -> str:
    """What the program prints for a command line with --json."""
