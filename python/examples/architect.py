"""How many contexts? Cycles, area and energy of one frame by the model."""

import shiftvox

text = shiftvox.hardware("light")
for contexts in (2, 4, 8):
    with open("mine.toml", "w") as file:
        file.write("\n".join(f"contexts = {contexts}" if line.startswith("contexts") else line
                             for line in text.splitlines()))
    found = shiftvox.model("bundled", size=64, hw="mine.toml")
    cycles = found["simulated"]["cycles"]["cycles"]
    energy = next(line for line in found["comparison"] if line["what"] == "energy of the frame")
    print(f"{contexts} contexts: {cycles:9,} cycles, {found['area']['total']:9,.0f} NAND2, {energy['light']:.0f} uJ")
