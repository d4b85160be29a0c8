# shellcheck shell=bash
# Run time against error: tables and pictures in docs/performance. usage: work_precision.sh PROGRAM [full|quick [SCENE...]]
# scipy (python3-scipy) and Octave (octave) are compared where they are installed.
set -euo pipefail
program=$1
scope=${2:-full}
shift $(($# > 2 ? 2 : $#))
results=docs/performance
work=out/bench
[[ $scope == full && $# == 0 ]] || results=out/bench/performance
mkdir -p "$results" "$work"
status=0
"$(dirname "$program")/bench/work_precision" "$program" "$work" "$results/work_precision.csv" "$results/tables.md" \
    "$scope" "$@" || status=1
cut -d, -f1 "$results/work_precision.csv" | tail -n +2 | sort -u | while read -r scene; do
    gnuplot -c bench/work_precision/draw.gp "$results/work_precision.csv" "$scene" "$results/$scene.png" \
        "$(sed -n "s/^## $scene: //p" "$results/tables.md")"
done
cat "$results/tables.md"
exit $status
