#!/usr/bin/env bash
# Every example's deck in plain ngspice, whole length, against our run at A = 1e-5 (converters 1e-4): relative L2
# difference of x and of the electrodes' voltages, unchanged and with its longest step and tolerances tightened as far
# as is practical. Exit code 1 when a tight deck differs by more than 1e-3. usage: decks.sh PROGRAM [NAME...]
set -euo pipefail
ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
DEASIM=$(realpath "$1")
export ROOT DEASIM
shift
# shellcheck source=tests/cli/deck.sh
source "$ROOT/tests/cli/deck.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

# Longest step, options, our accuracy.
settings_of() {
    case $1 in
    self_sensing) echo '5u reltol=1e-5 1e-5' ;;
    cockcroft_walton) echo '0.5u reltol=1e-5 1e-4' ;;
    bidirectional_flyback) echo '0.05u reltol=1e-5,trtol=1 1e-4' ;;
    flyback_*) echo '0.02u reltol=1e-4,trtol=1 1e-4' ;;
    *) echo '10u reltol=1e-5 1e-5' ;;
    esac
}

# differences EXAMPLE RAW: largest of x and of the voltages, and the points of the deck.
differences() {
    local pair one x=0 port=0
    for pair in $(pairs_of "$1"); do
        one=$(compare "${pair%%=*}" "${pair#*=}" "$2")
        case ${pair%%=*} in
        x | *.x) x=$(printf '%s\n%s\n' "$x" "$one" | sort -g | tail -n 1) ;;
        *) port=$(printf '%s\n%s\n' "$port" "$one" | sort -g | tail -n 1) ;;
        esac
    done
    printf '%.1e %.1e %d\n' "$x" "$port" "$(wc -l <vector.txt)"
}

# Only the voltages compared, so that the file of a converter stays small.
save_pairs() {
    local nodes
    nodes=$(pairs_of "$1" | grep -oE 'v\([^)]*\)' | sed -E 's/v\(([^,)]*),([^)]*)\)/v(\1) v(\2)/' | tr '\n' ' ')
    sed "s/^\.end\$/.save $nodes\n.end/"
}

printf '%-26s %-9s %9s %9s %9s  %-28s %9s %9s %9s %6s\n' example ours 'deck: x' port points 'tight' x port points s
failed=0
names=("$@")
(($#)) || for path in "$ROOT"/examples/*.yaml; do names+=("$(basename "$path" .yaml)"); done
for name in "${names[@]}"; do
    path=$ROOT/examples/$name.yaml
    scene=$path
    read -r step options accuracy <<<"$(settings_of "$name")"
    expect 0 "$DEASIM" export "$path" -o deck.cir
    expect 0 "$DEASIM" run "$path" --accuracy "$accuracy" --set 'output.formats=[csv]' -o run -q
    save_pairs "$path" <deck.cir >plain.cir
    expect 0 ngspice -b -r plain.raw plain.cir
    read -r x port points <<<"$(differences "$path" plain.raw)"
    printf '%-26s %-9s %9s %9s %9s  ' "$name" "$accuracy" "$x" "$port" "$points"
    tighten "$step" "${options//,/ }"
    save_pairs "$path" <tight.cir >saved.cir
    started=$(date +%s.%N)
    if ! ngspice -b -r tight.raw saved.cir >out 2>err; then
        printf '%s %s: %s  <<<\n' "$step" "$options" "$(grep -ioE 'Timestep too small.*' err | head -n 1)"
        ((failed += 1))
        continue
    fi
    ended=$(date +%s.%N)
    read -r x port points <<<"$(differences "$path" tight.raw)"
    awk -v x="$x" -v p="$port" -v n="$points" -v s="$step" -v o="$options" -v a="$started" -v b="$ended" 'BEGIN {
        bad = !(x >= 0 && x <= 1e-3 && p >= 0 && p <= 1e-3)
        printf "%-28s %9s %9s %9d %6.1f%s\n", s " " o, x, p, n, b - a, bad ? "  <<<" : ""; exit bad }' || ((failed += 1))
done
printf '%d passed, %d failed\n' $((${#names[@]} - failed)) "$failed"
((failed == 0))
