#!/usr/bin/env bash
# Drives the fuzz targets with libFuzzer, one after the other, from the kept corpus and the scenes and netlists of the
# tree. New finds stay in out/fuzz; `run.sh ... keep` puts a minimal corpus of them into the tree afterwards.
#   usage: run.sh BUILD SECONDS [scene|waveform|netlist|all [keep]]
set -uo pipefail
build=$(realpath "$1") || exit 2
seconds=$2
target=${3:-all}
keep=${4:-}
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 4
[[ $target == all ]] && targets=(netlist scene waveform) || targets=("$target")
out=$PWD/out/fuzz # the targets change the current folder
corpus=$PWD/tests/fuzz/corpus

# The file a scene, device or waveform names, with this ending; nothing when there is none.
named_file() { # FILE ENDING
    local name
    name=$(grep -oE "[A-Za-z0-9_./]*$2" "$1" | head -n 1)
    [[ -n $name && -f $(dirname "$1")/$name ]] && printf '%s/%s' "$(dirname "$1")" "$name"
}

# One input of a scene: itself, its device, its material, its waveform, settings.
scene_seed() {
    local device base material wave
    device=$(named_file "$1" 'models/[a-z0-9_]+\.yaml')
    base=${device:+$(sed -n 's/^base: //p' "$device")}
    [[ -z $base ]] || device=$(dirname "$device")/$base
    sed -E 's|[a-zA-Z0-9_./]*models/[a-z0-9_]+\.yaml|device.yaml|g; s|[a-z_]+\.csv|wave.csv|' "$1"
    printf '=====\n'
    [[ -z $device ]] || sed -E 's|materials/[a-z0-9_]+\.yaml|material.yaml|' "$device"
    printf '=====\n'
    material=${device:+$(named_file "$device" 'materials/[a-z0-9_]+\.yaml')}
    if [[ -n $material ]]; then
        base=$(sed -n 's/^base: //p' "$material")
        [[ -z $base ]] || sed '/^name:/d' "$(dirname "$material")/$base"
        sed '/^base:/d' "$material"
    fi
    printf '=====\n'
    wave=$(named_file "$1" '[a-z_]+\.csv')
    [[ -z $wave ]] || cat "$wave"
    printf '=====\ntransient.accuracy=1e-4\n'
}

netlist_seed() {
    sed -E 's|^(\.include\|\.lib) +[^ ]+|\1 part.inc|' "$1"
    printf '=====\n'
    cat netlists/parts/*
}

write_seeds() {
    local folder=$out/seeds/$1 path
    mkdir -p "$folder"
    case $1 in
    scene) for path in examples/*.yaml tests/cases/*.yaml; do scene_seed "$path" >"$folder/$(basename "$path")"; done ;;
    netlist) for path in netlists/*.cir; do netlist_seed "$path" >"$folder/$(basename "$path")"; done ;;
    waveform) cp tests/cases/*.csv tests/data/*.csv "$folder" ;;
    esac
}

status=0
TMPDIR=$(mktemp -d -p "$([[ -w /dev/shm ]] && echo /dev/shm || echo /tmp)")
export TMPDIR LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0
trap 'rm -rf "$TMPDIR"' EXIT
for name in "${targets[@]}"; do
    program=$build/tests/fuzz_$name
    [[ -x $program ]] || { echo "fuzz: $program is not there" >&2; exit 2; }
    mkdir -p "$out/$name" "$out/finds" "$corpus/$name"
    write_seeds "$name"
    if ((seconds > 0)); then
        printf '\n== fuzz %s, %d s\n' "$name" "$seconds"
        "$program" "$out/$name" "$corpus/$name" "$out/seeds/$name" -dict="$PWD/tests/fuzz/$name.dict" -max_len=8192 \
            -max_total_time="$seconds" -timeout=5 -rss_limit_mb=2000 -artifact_prefix="$out/finds/$name-" \
            -print_final_stats=1 >"$out/$name.log" 2>&1 || status=1
        grep -aE '^(#[0-9]+.*DONE|stat::|==.*ERROR|SUMMARY|does not hold|Test unit)' "$out/$name.log"
    fi
    if [[ $keep == keep ]]; then
        rm -rf "$out/kept"
        mkdir -p "$out/kept"
        "$program" -set_cover_merge=1 -use_counters=0 -max_len=4096 "$out/kept" "$corpus/$name" "$out/seeds/$name" \
            "$out/$name" >"$out/$name.merge.log" 2>&1 || status=1
        grep -rlaE '/dev/shm|/tmp' "$out/kept" | xargs -r rm # names of this machine, seen in comparisons
        rm -rf "${corpus:?}/$name"
        mv "$out/kept" "$corpus/$name"
    fi
done
exit $status
