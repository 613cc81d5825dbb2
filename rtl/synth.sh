#!/bin/sh
# Area and delay of modules, as the rows of hwmodel/tables/area.toml were made: Yosys, OSU 0.18 um cells.
# synth.sh FILE MODULE...  prints `module,nand2,registers_nand2,delay_ps` for each; areas are in NAND2X1 of
# 24 um2, delays of gates alone. Needs yosys and qflow-tech-osu018; LIBERTY names another library.
set -e
cd "$(dirname "$0")"
lib=${LIBERTY:-/usr/share/qflow/tech/osu018/osu018_stdcells.lib}
[ -f "$lib" ] || { echo "no $lib: apt-get install qflow-tech-osu018" >&2; exit 1; }
log=$(mktemp)
trap 'rm -f "$log"' EXIT
# STAGE=stage_b: modules of exact coverage in the place of those of the same name.
stage=${STAGE:-stage_a}
folders="machine $stage blocks"
[ "$stage" = stage_a ] || folders="machine $stage blocks_exact blocks"
files=$(for folder in $folders; do ls "$folder"/*.v; done | awk -F/ '!seen[$NF]++')
files=$(echo $files)
script='+strash;ifraig;scorr;dc2;strash;&get,-n;&dch,-f;&nf;&put;topo;stime'
for top in "$@"; do
  yosys -p "read_verilog -sv -I. -I$stage ${DEFINES:-} $files; hierarchy -top $top; ${BOX:-}
    synth -flatten -top $top; dfflibmap -liberty $lib; abc -liberty $lib -script $script; opt_clean -purge
    stat -liberty $lib" > "$log" 2>&1 || { tail -5 "$log" >&2; exit 1; }
  awk -v top="$top" '
    /Delay *=/ { for (i = 1; i <= NF; i++) if ($i == "Delay") { v = $(i + 2); if (v > delay) delay = v } }
    /^ +DFF/ { registers += $2 }
    /Chip area/ { area = $NF }
    END { printf "%s,%.1f,%.1f,%.0f\n", top, area / 24, registers * 96 / 24, delay }' "$log"
done
