"""Writes small seed files of each reader into corpus/READER; run in fuzz/."""

import base64
import gzip
import json
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

BINVOX = {"usual": b"1\ndim 2 3 4\ntranslate 0 0 0\nscale 1\ndata\n\0\5\1\3\0\20"}
XYZ_TEXT = {"plain": b"# a\n0.5 1 2\n-3 4 5\n", "colors": b"1,2,3,255,0,9\n4,5,6,1,2,3\n", "pts": b"1 2 3 7 255 0 9\n"}
FIELDS = b"0.7\nFIELDS a x y z rgb\nSIZE 2 4 4 4 4\nTYPE U F F F F\nCOUNT 2 1 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA "
PCD = {"text": FIELDS + b"ascii\n1 2 0.5 1 nan 0\n1 2 3 4 5 4e-39\n", "binary": FIELDS + b"binary\n" + bytes(range(20)) * 2}
PLACE = numbers(2, 1, 2, 5, 6, -7)
QB = {
    "plain": numbers(0, 0, 0, 0, 1) + b"\1a" + PLACE + numbers(0xFF0000C8, 0, 1 << 24, 0xFF0000C8),
    "packed": numbers(1, 1, 1, 1, 1) + b"\0" + PLACE + numbers(2, 2, 0xFF0000C8, 6, 0, 0x01020304, 6),
}


def tag(kind, name, content):
    return bytes([kind]) + struct.pack(">H", len(name)) + name.encode() + content


def compound(name, *entries):
    return tag(10, name, b"".join(entries) + b"\0")


def array(kind, name, count, content):
    return tag(kind, name, struct.pack(">i", count) + content)


def vector(name, *values):
    return compound(name, *(tag(3, axis, struct.pack(">i", value)) for axis, value in zip("xyz", values)))


def named(name):
    return tag(8, "Name", struct.pack(">H", len(name)) + name.encode()) + b"\0"


SIZE = b"".join(tag(2, name, struct.pack(">h", side)) for name, side in (("Width", 2), ("Height", 1), ("Length", 2)))
STATES = compound("Palette", tag(3, "minecraft:air", bytes(4)), tag(3, "oak_log[axis=y]", struct.pack(">i", 300)))
BLOCKS = b"\0\xac\2\xac\2\0"
TWO = compound("Schematic", SIZE, STATES, array(7, "BlockData", 6, BLOCKS), tag(5, "a", bytes(4)), array(11, "b", 1, bytes(4)))
THREE = compound("", compound("Schematic", SIZE, compound("Blocks", STATES, array(7, "Data", 6, BLOCKS))))
KINDS = tag(9, "BlockStatePalette", b"\n" + struct.pack(">i", 2) + named("air") + named("minecraft:stone"))
REGION = compound("one", vector("Position", 1, 2, 3), vector("Size", -2, 1, 2), KINDS, array(12, "BlockStates", 1, struct.pack(">Q", 0x51)))
FILES = {"two": TWO, "three": THREE, "litematic": compound("", compound("Regions", REGION))}
# The marks are 1f 8b of gzip and 0a 00 of NBT.
SCHEM = {name: file[2:] for name, file in FILES.items()}
VOXELS = {"vox": VOX, "ply": PLY, "npy": NPY, "binvox": BINVOX, "xyz": XYZ_TEXT, "pcd": PCD, "qb": QB}
# The first byte selects the mark, and with its two highest bits the size of a voxel.
SEEDS = {
    reader: {f"{name}_{size}": bytes([size]) + seed for name, seed in seeds.items() for size in (0, 64, 128, 192)}
    for reader, seeds in VOXELS.items()
}
SEEDS["schem"] = {name: b"\1" + seed for name, seed in SCHEM.items()}
SEEDS["schem"] |= {f"{name}_gzip": b"\0" + gzip.compress(file)[2:] for name, file in FILES.items()}

# A triangle and a square of two: positions, normals, indices.
BUFFER = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 2) + struct.pack("<12f", *(0, 0, 1) * 4) + struct.pack("<6H", 0, 1, 2, 0, 2, 3)


def gltf(**more):
    """The same mesh, with a node that scales and one that turns it."""
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(BUFFER)}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 48}, {"buffer": 0, "byteOffset": 96, "byteLength": 12}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1]}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}]}],
        "nodes": [{"mesh": 0, "scale": [2, 1, 1], "children": [1]}, {"mesh": 0, "rotation": [0, 0, 0.7071068, 0.7071068], "translation": [3, 0, 0]}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }
    document.update(more)
    return document


def text(document):
    return json.dumps(document, separators=(",", ":")).encode()


def glb(document):
    """A byte that, times 16, says where the buffer begins, itself counted."""
    body = text(document)
    cut = (len(body) + 1 + 15) // 16
    return bytes([cut]) + body.ljust(16 * cut - 1) + BUFFER


INSIDE = {"byteLength": len(BUFFER), "uri": "data:application/octet-stream;base64," + base64.b64encode(BUFFER).decode()}
INSTANCES = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}
SPARSE = {"count": 2, "indices": {"bufferView": 2, "componentType": 5123}, "values": {"bufferView": 0}}
ACCESSORS = gltf()["accessors"]
STRIP = [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}]
COLORS = [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "mode": 6}]}]
SMALL = {"materials": [{}], "nodes": [{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}]}
GLTF = {
    "inside": text(gltf(buffers=[INSIDE])),
    "strip": text(gltf(buffers=[INSIDE], meshes=STRIP)),
    "sparse": text(gltf(buffers=[INSIDE], accessors=[ACCESSORS[0] | {"sparse": SPARSE}, *ACCESSORS[1:]])),
    "instances": text(gltf(buffers=[INSIDE], nodes=[{"mesh": 0, "extensions": INSTANCES}])),
    "none": text({"asset": {"version": "2.0"}}),
}
GLB = {
    "binary": glb(gltf()),
    "fan": glb(gltf(meshes=COLORS)),
    "matrix": glb(gltf(**SMALL)),
}

MTL = b"newmtl a\nKd 1 0.5 0\nd 0.5\nnewmtl b\nKd 0.1\nTr 0.2\nKa 1 1 1\nmap_Kd a.png\n"
OBJ = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 2\nvn 0 0 1\nvt 0 0\no a\ng b c\nusemtl a\nf 1//1 2//1 3//1\nusemtl b\nf -1/1 1/1 2/1 3/1\nl 1 2\n"
CORNERS = b"element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
FACES = b"element face 1\nproperty list uchar int vertex_indices\nend_header\n"
SQUARE = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 1, 1, 0)
STL = b"a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\nendsolid a\n"
COLORED = b"".join(b"v %d %d %d 0.5 %d 0\n" % (k, k & 1, k * k, k & 1) for k in range(4)) + b"f 1 2 3\nf 2 3 4\n"
SEEDS |= {"gltf": GLTF, "glb": GLB}
SEEDS["obj"] = {"usual": OBJ + b"\n%\n" + MTL, "colored": COLORED}
SEEDS["ply-mesh"] = {
    "ascii": b"format ascii 1.0\n" + CORNERS + FACES + b"0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n",
    "little": b"format binary_little_endian 1.0\n" + CORNERS + FACES + SQUARE + b"\3" + numbers(0, 1, 2),
    "strips": b"format ascii 1.0\n" + CORNERS + b"element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    + b"0 0 0\n1 0 0\n1 1 0\n7 0 1 2 -1 2 1 0\n",
    "faces": b"format ascii 1.0\n" + CORNERS + FACES.replace(b"end", b"property uchar red\nproperty uchar green\nproperty uchar blue\nend")
    + b"0 0 0\n1 0 0\n1 1 0\n3 0 1 2 255 0 9\n",
}
SEEDS["stl"] = {
    "text": b"solid " + STL,
    "binary": bytes(80) + numbers(1) + struct.pack("<3f", 0, 0, 1) + SQUARE + bytes(2),
}
# Choices that compose a scene graph, and choices of a sound file and its edits.
SEEDS["vox-graph"] = {f"{seed}": bytes(i * seed % 256 for i in range(200)) for seed in (34, 57, 91)}
for reader in ("vxg", "far", "tvx"):
    SEEDS[reader] = {f"{file}": numbers(file, 0, *(2654435761 * i for i in range(1, 7))) for file in range(4)}

for reader, seeds in SEEDS.items():
    folder = pathlib.Path("corpus") / reader
    folder.mkdir(parents=True, exist_ok=True)
    for name, seed in seeds.items():
        (folder / name).write_bytes(seed)
