#!/bin/sh
# Remakes the pictures of meshes on the pages alpha, far-voxels, meshes and textured-voxels:
#
#     docs/pictures/remake.sh MESHES      # the folder of the meshes that docs/meshes.md names; needs ImageMagick
#
# A picture is of crops, enlarged, beside one another with a white line between.
set -eu
meshes=$(cd "$1" && pwd)
docs=$(cd "$(dirname "$0")/.." && pwd)
cargo build --release --quiet --manifest-path "$docs/../Cargo.toml"
program=$docs/../target/release/shiftvox
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

oak=$meshes/tree_Oak_Large.obj
kitchen=$meshes/kitchen.obj
house=$meshes/as_AC14-FZK-Haus.obj

# draw NAME ARGUMENTS...: one picture. beside CROP SCALE OUT NAME...: pictures beside one another.
draw() { to=$1; shift; "$program" "$@" -o "$to.png" --force --quiet > /dev/null; }
beside() {
    crop=$1 scale=$2 to=$3; shift 3
    for part; do set -- "$@" "$part.png"; shift; done
    convert "$@" -gravity center -crop "${crop}x$crop+0+0" +repage -sample "$scale%" -background white +smush 6 \
        -strip "$to"
}
# far_row NAME MESH ARGUMENTS...: opaque voxels, triangles at 256 samples, six opacities, triangles at 1 sample.
far_row() {
    name=$1 mesh=$2; shift 2
    [ -f "$name.far" ] || "$program" convert "$mesh" "$name.far" --quiet > /dev/null
    draw "$name-none" render "$name.far" --engine far --far-opacity none "$@"
    draw "$name-six" render "$name.far" --engine far --far-opacity six "$@"
    draw "$name-256" triangles "$mesh" --samples 256 "$@"
    draw "$name-1" triangles "$mesh" --samples 1 "$@"
}

far_row platform "$meshes/platform.obj" --zoom 0.3 --size 160
beside 50 500 "$docs/far/platform.png" platform-none platform-256 platform-six platform-1
far_row ship "$meshes/CG-57.obj" --zoom 0.5 --size 200
beside 90 300 "$docs/far/ship.png" ship-none ship-256 ship-six
for name in kitchen house; do
    eval mesh=\$$name
    far_row $name "$mesh" --zoom 0.3 --size 192
    beside 80 400 $name-row.png $name-none $name-256 $name-six $name-1
    draw $name-near render $name.far --engine far --zoom 1.2 --size 192
    draw $name-near-4 render $name.far --engine far --zoom 1.2 --size 192 --aa 4
    draw $name-near-256 triangles "$mesh" --zoom 1.2 --size 192 --samples 256
    beside 192 200 $name-near-row.png $name-near $name-near-4 $name-near-256
done
convert kitchen-row.png house-row.png -background white -smush 6 -strip "$docs/far/kitchen-house.png"
convert kitchen-near-row.png house-near-row.png -background white -smush 6 -strip "$docs/far/samples.png"

# alpha_row NAME MESH ARGUMENTS...
alpha_row() {
    name=$1 mesh=$2; shift 2
    draw "$name-256" triangles "$mesh" --samples 256 --size 96 "$@"
    for rule in any exact alpha; do
        draw "$name-$rule" render "$mesh" --coverage $rule --size 96 "$@"
    done
    draw "$name-aa" render "$mesh" --coverage exact --aa 4 --size 96 "$@"
    draw "$name-lod" render "$mesh" --coverage alpha --lod 2 --size 96 "$@"
    beside 96 200 "$docs/alpha/$name.png" "$name-256" "$name-any" "$name-exact" "$name-aa" "$name-alpha" "$name-lod"
}
alpha_row oak "$oak" --depth 8 --zoom 0.6
alpha_row wires "$docs/../assets/wires.obj" --depth 9 --zoom 0.9

cd "$docs/pictures"
for of in oak:1.1 house:1.3; do
    name=${of%:*}
    eval mesh=\$$name
    draw mesh-$name-voxels render "$mesh" --depth 9 --aa 4 --size 480x360 --zoom "${of#*:}"
    draw mesh-$name-triangles triangles "$mesh" --samples 256 --size 480x360 --zoom "${of#*:}"
done
for of in oak:0 oak:1 oak:2 kit:0; do
    name=${of%:*}
    mesh=$oak
    [ $name = oak ] || mesh=$kitchen
    [ -f "$work/$name.tvx" ] || "$program" convert "$mesh" "$work/$name.tvx" --quiet > /dev/null
    draw textured-$name-"${of#*:}" render "$work/$name.tvx" --engine textured --erosion "${of#*:}" --aa 4 --size 360x330
    draw textured-$name-tri triangles "$mesh" --samples 16 --size 360x330
done
