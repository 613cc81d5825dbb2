"""A picture of voxels from an array, and its buffers."""

import numpy as np

import shiftvox

# A torus, coloured by position.
index = np.stack(np.meshgrid(*[np.arange(-24, 25)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
ring = np.hypot(np.hypot(index[:, 0], index[:, 1]) - 16, index[:, 2])
index = index[(ring > 6) & (ring < 8)].astype(np.int32)
color = (128 + 5 * index).clip(0, 255).astype(np.uint8)

scene = shiftvox.Scene.from_numpy(index, color)
camera = shiftvox.Camera.fit(scene, azimuth=30, elevation=40)
picture = shiftvox.render(scene, camera, size=(320, 240), samples=2)
picture.save_png("torus.png")

seen = picture.nodes >= 0
print(f"{scene.voxels} voxels, {len(np.unique(picture.voxels[seen], axis=0))} of them seen")
print(f"depth {picture.depth[seen].min():.1f} to {picture.depth[seen].max():.1f}")
