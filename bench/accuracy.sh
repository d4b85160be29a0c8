# shellcheck shell=bash
# Delivered against asked accuracy over all scenes: table, rows and picture. usage: accuracy.sh PROGRAM [--quick | SCENE...]
# With scenes named, or --quick (the benchmark's own), results go to out/bench only.
set -uo pipefail
program=$1
shift
results=docs/performance
shopt -s nullglob
scenes=("$@")
[[ ${1:-} != --quick ]] || scenes=(bench/scenes/*.yaml)
if ((${#scenes[@]} == 0)); then
    scenes=(examples/*.yaml bench/scenes/*.yaml tests/cases/*.yaml)
else
    results=out/bench/accuracy
fi
mkdir -p "$results" out/bench/accuracy
"$(dirname "$program")/bench/accuracy" "$program" out/bench/accuracy "$results/accuracy.csv" \
    out/bench/accuracy/table.md "${scenes[@]}"
status=$?
cat out/bench/accuracy/table.md
gnuplot -c bench/accuracy/draw.gp "$results/accuracy.csv" "$results/accuracy.png" || exit
exit $status
