"""Writes small seed files for the three input targets into corpus/; run in fuzz/."""

import pathlib
import struct


def numbers(*values):
    return b"".join(struct.pack("<I", value & 0xFFFFFFFF) for value in values)


def chunk(name, content):
    return name + numbers(len(content), 0) + content


def attributes(**entries):
    texts = b"".join(numbers(len(t)) + t.encode() for pair in entries.items() for t in pair)
    return numbers(len(entries)) + texts


MODEL = chunk(b"SIZE", numbers(4, 3, 2)) + chunk(b"XYZI", numbers(3) + bytes([0, 1, 1, 5, 3, 2, 0, 255, 250, 0, 9, 0]))
GRAPH = (
    chunk(b"nTRN", numbers(0) + attributes() + numbers(1, -1, -1, 1) + attributes())
    + chunk(b"nGRP", numbers(1) + attributes() + numbers(2, 2, 4))
    + chunk(b"nTRN", numbers(2) + attributes(_hidden="1") + numbers(3, -1, 0, 2) + attributes(_t="1 -2 3", _f="0") + attributes(_r="17", _f="9"))
    + chunk(b"nSHP", numbers(3) + attributes() + numbers(2, 0) + attributes(_f="0") + numbers(1) + attributes(_f="3"))
    + chunk(b"nTRN", numbers(4) + attributes() + numbers(5, -1, 1, 1) + attributes(_r="40", _t="0 0 99"))
    + chunk(b"nSHP", numbers(5) + attributes() + numbers(1, 0) + attributes())
    + chunk(b"LAYR", numbers(1) + attributes(_hidden="0") + numbers(-1))
    + chunk(b"RGBA", bytes(range(16)))
    + chunk(b"IMAP", bytes(range(256)))
)
VOX = {"bare": MODEL, "two": MODEL + MODEL, "graph": MODEL + MODEL + GRAPH, "wrong": GRAPH}

XYZ = b"element vertex 2\nproperty %s x\nproperty %s y\nproperty %s z\n"
COLOR = b"property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\nproperty float ny\nproperty float nz\n"
LIST = b"element a 1\nproperty list uchar short b\n"
PLY = {
    "ascii": b"format ascii 1.0\ncomment c\n" + XYZ % ((b"int",) * 3) + b"end_header\n1 2 3\n-4 5 6\n",
    "little": b"format binary_little_endian 1.0\n" + XYZ % ((b"float",) * 3) + COLOR + b"end_header\n"
    + struct.pack("<3f3B3f", 1, 2, 3, 4, 5, 6, 0, 0, 1) * 2,
    "big": b"format binary_big_endian 1.0\n" + LIST + XYZ % ((b"short",) * 3) + b"end_header\n\1\0\7" + struct.pack(">6h", *range(6)),
}


def npy(version, header, data):
    size = struct.pack("<H" if version == 1 else "<I", len(header))
    return bytes([version, 0]) + size + header + data


NPY = {
    "c": npy(1, b"{'descr': '<i2', 'fortran_order': False, 'shape': (2, 3), }", bytes(12)),
    "fortran": npy(2, b"{'descr': '>f4', 'fortran_order': True, 'shape': (2, 3), }", bytes(24)),
    "color": npy(3, b"{'descr': '|u1', 'fortran_order': False, 'shape': (2, 7), }", bytes(14)),
}

for target, seeds in {"vox": VOX, "ply": PLY, "npy": NPY}.items():
    folder = pathlib.Path("corpus") / target
    folder.mkdir(parents=True, exist_ok=True)
    for name, seed in seeds.items():
        # The target for .vox takes a byte of options first.
        for option in ([0, 4, 0x91] if target == "vox" else [None]):
            prefix = b"" if option is None else bytes([option])
            (folder / f"{name}_{option}").write_bytes(prefix + seed)
