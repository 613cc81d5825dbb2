#!/bin/sh
# Area and delay of modules with Yosys and OSU 0.18 um cells, as in hwmodel/tables/area.toml. Areas are in NAND2X1 of
# 24 um2, delays of gates only. Needs yosys and qflow-tech-osu018; LIBERTY names another library.
#
#   synth.sh MODULE...   prints `module,nand2,registers_nand2,delay_ps` of each, without memories. PARAMETERS overrides
#                        parameters ("-chparam LANES 4"), BOXES=machine leaves that module out, too
#   synth.sh machine     prints `stage,part,nand2,registers_nand2` of the whole machine without memories: the parts of
#                        parts.txt (B and C: parts_exact.txt), the rest, their sum, and the machine in one piece.
#                        Default PARAMETERS: the bundled tree at 64 x 64. Takes minutes
#
# Modules are those of stage A. STAGE=stage_b or stage_c replaces them by those of exact coverage.
set -e
cd "$(dirname "$0")"
lib=${LIBERTY:-/usr/share/qflow/tech/osu018/osu018_stdcells.lib}
[ -f "$lib" ] || { echo "no $lib: apt-get install qflow-tech-osu018" >&2; exit 1; }
log=$(mktemp)
trap 'rm -f "$log"' EXIT
stage=${STAGE:-stage_a}
folders="machine $stage blocks"
case $stage in
  stage_b) folders="machine stage_b blocks_exact blocks" ;;
  stage_c) folders="machine stage_c stage_b blocks_exact blocks" ;;
esac
include="-I.$(printf ' -I%s' $folders)"
files=$(for folder in $folders; do ls "$folder"/*.v; done | awk -F/ '!seen[$NF]++')
# Memories are black boxes.
boxes=$(printf 'machine/%s.v\n' memory ${BOXES:-})
read="read_verilog -sv $include ${DEFINES:-} $(echo "$files" | grep -v -x -F "$boxes" | tr '\n' ' ')
  read_verilog -lib -sv $include $(echo $boxes)"
script='+strash;ifraig;scorr;dc2;strash;&get,-n;&dch,-f;&nf;&put;topo;stime'
cells="dfflibmap -liberty $lib; abc -liberty $lib -script $script; opt_clean -purge; stat -liberty $lib"

# synthesize COMMANDS: runs Yosys with its output in $log
synthesize() {
  yosys -p "$1" > "$log" 2>&1 || { tail -5 "$log" >&2; exit 1; }
}

whole_machine() {
  case $stage in
    stage_a) parts=parts.txt bound=13 ;;
    *) parts=parts_exact.txt bound=8 ;;
  esac
  widths="-chparam PICTURE_LEVELS 6 -chparam LEVEL_BOUND $bound -chparam DEPTH 8 -chparam NODE_WIDTH 21"
  parameters=${PARAMETERS:-$widths}
  # Only constants are propagated before the parts are cut out.
  read="$read
    hierarchy -top machine $parameters; proc; flatten; opt_expr; opt_clean; memory; opt_clean; rename -top machine"
  cut=$(awk '!/^#/ { list = ""
      for (i = 3; i <= NF; i++) list = list " machine/" (sub("^@", "", $i) ? "a:src=*" $i "*" : "c:*" $i ".*")
      print "submod -name part_" $2 list }' $parts)
  own='select -set own machine/c:* machine/c:*flatten* %d; select -set sums machine/t:$add machine/t:$sub machine/t:$neg
    select -set shifts machine/t:$shl machine/t:$shr machine/t:$shift machine/t:$shiftx
    submod -name part_sums @own @sums %i; submod -name part_shifters @own @shifts %i'
  # Cutting must keep the number of cells.
  synthesize "$read; stat; $cut
    $own
    stat; synth -top machine; $cells"
  awk '/Printing statistics/ { at++ } /Number of cells/ { if (at == 1) before = $NF; if (at == 2) after = $NF }
    END { if (before != after) { print before " cells, cut into " after > "/dev/stderr"; exit 1 } }' "$log"
  awk '
    FNR == NR { if (!/^#/) stage["part_" $2] = $1; next }
    /Printing statistics/ { registers = 0 }
    /^=== / { of = $2; registers = 0 }
    /^ +DFF/ { registers += $2 * 96 / 24 }
    /Chip area for module/ {
      area = $NF / 24; sum += area; sum_registers += registers; name = of; sub("part_", "", name)
      printf "%s,%s,%.0f,%.0f\n", of in stage ? stage[of] : "-", of == "machine" ? "states" : name, area, registers }
    END { printf "all,sum,%.0f,%.0f\n", sum, sum_registers }' $parts "$log"
  synthesize "$read; synth -flatten -top machine; $cells"
  awk '/^ +DFF/ { registers += $2 * 96 / 24 } /Chip area/ { area = $NF / 24 }
    END { printf "all,one piece,%.0f,%.0f\n", area, registers }' "$log"
}

for top in "$@"; do
  if [ "$top" = machine ]; then whole_machine; continue; fi
  synthesize "$read
    hierarchy -top $top ${PARAMETERS:-}; rename -top $top
    synth -flatten -top $top; $cells"
  awk -v top="$top" '
    /Delay *=/ { for (i = 1; i <= NF; i++) if ($i == "Delay") { v = $(i + 2); if (v > delay) delay = v } }
    /^ +DFF/ { registers += $2 }
    /Chip area/ { area = $NF }
    END { printf "%s,%.1f,%.1f,%.0f\n", top, area / 24, registers * 96 / 24, delay }' "$log"
done
