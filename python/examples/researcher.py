"""How does the work of an engine grow with the picture? A power law, fitted with NumPy."""

import numpy as np

import shiftvox

scene = shiftvox.Scene.generate("terrain,depth=8,seed=1")
sides = np.array([32, 64, 128, 256])
for engine, counter in (("fast", "records"), ("machine", "records")):
    work = [shiftvox.render(scene, size=int(side), engine=engine).counters[counter] for side in sides]
    exponent = np.polyfit(np.log(sides**2), np.log(work), 1)[0]
    print(f"{engine}: {work} {counter}, growing as pixels to the {exponent:.2f}")
