# shellcheck shell=bash
# Error against run time and work: tables and pictures. usage: work_precision.sh PROGRAM [OPTION]... [SCENE]...
#   --quick      a first look: few settings, three rounds, short limits; the page is out/bench/quick/performance.md
#   --minutes N  time of a campaign over all scenes (25; quick: 4); each scene has its share
#   --again      measure afresh what an earlier campaign of this program has finished
#   --publish    a quick campaign also writes docs/performance.md
# A full campaign goes on where it was interrupted: a scene whose CSV in out/bench/full is newer than the program is
# done. Once every scene is, it writes docs/performance/SCENE.csv and .png and the part of docs/performance.md between
# its two marks; until then its page is out/bench/full/performance.md.
# scipy (python3-scipy) and Octave (octave) are compared where they are installed.
set -euo pipefail
program=$1
shift
scope=full minutes=25 again=0 publish=0 wanted=()
while (($#)); do
    case $1 in
    --quick) scope=quick minutes=4 ;;
    --minutes) minutes=$2; shift ;;
    --again) again=1 ;;
    --publish) publish=1 ;;
    -*) printf 'work_precision.sh: unknown option %s\n' "$1" >&2; exit 2 ;;
    *) wanted+=("$1") ;;
    esac
    shift
done
[[ $scope == quick ]] || publish=1
measure=$(dirname "$program")/bench/work_precision
work=out/bench/$scope
mkdir -p "$work"
mapfile -t scenes < <("$measure" --list)
((${#wanted[@]})) || wanted=("${scenes[@]}")
status=0

# ---- measuring ----

is_done() { ((!again)) && [[ $scope == full && $work/$1.csv -nt $program ]]; }

# The conditions are noted per scene: an interrupted campaign may go on another day.
measure_scene() {
    local load
    read -r load _ </proc/loadavg
    "$measure" "$program" "$work" "$work" "$scope" "$((minutes * 60))" "$1" || return 1
    printf '%s %s\n' "$(date +%F)" "$load" >"$work/$1.conditions"
}

for scene in "${wanted[@]}"; do
    if is_done "$scene"; then
        printf '%s: done before\n' "$scene"
    else
        measure_scene "$scene" || { printf '%s: failed\n' "$scene" >&2; status=1; }
    fi
done

# ---- the page ----

# Largest load of the minute before a scene began, and the days.
conditions() {
    cat "$work"/*.conditions | awk '{ if ($2 > load) load = $2; if (!first || $1 < first) first = $1; if ($1 > last) last = $1 }
        END { printf "%s; the largest load average before a scene was %.1f", first == last ? first : first " to " last, load }'
}

version() { dpkg-query -W -f='${Version}' "$1" 2>/dev/null || printf 'not installed'; }

machine() {
    printf 'Machine: %s, %d cores, %s, %s. ' "$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1)" "$(nproc)" \
        "$(awk '/MemTotal/ { printf "%.0f GB", $2 / 1e6 }' /proc/meminfo)" \
        "$(sed -n 's/^PRETTY_NAME="\(.*\)"$/\1/p' /etc/os-release)"
    printf 'ngspice %s, SUNDIALS %s, scipy %s, Octave %s. ' "$(version ngspice)" "$(version libsundials-dev)" \
        "$(version python3-scipy)" "$(version octave)"
    printf 'Measured %s.' "$(conditions)"
    [[ $scope == full ]] || printf ' **A quick pass: few settings, at most three rounds.**'
    printf '\n'
}

collect() {
    local scene
    for scene in "${scenes[@]}"; do
        [[ ! -f $work/$scene.$1 ]] || cat "$work/$scene.$1"
    done
}

generated() {
    machine
    printf '\n## All scenes\n\n'
    cat <<'TEXT'
Seconds deasim takes for an error of 1e-3, and how many times as long the others take for the error at the head of the column: solving
alone, in brackets the whole process. `-`: this error was not reached within the limits.

| scene | mode | deasim 1e-3 | ngspice 1e-2 | ngspice 1e-3 | ngspice 1e-4 | fixed exchange 1e-2 | fixed exchange 1e-3 | best script 1e-4 |
|---|---|---|---|---|---|---|---|---|
TEXT
    collect summary
    cat <<'TEXT'

## Coupled against the electronics alone

The same netlist at the same tolerances in plain ngspice, with a fixed capacitor where the device was: what the device costs a converter.
Times are whole processes, least of the runs.

| scene | | coupled | alone | time, x | median, x | points coupled | points alone | points, x | iterations, x |
|---|---|---|---|---|---|---|---|---|---|
TEXT
    collect overhead
    printf '\n## Scene by scene\n\n'
    collect section
}

# Puts the generated part between the marks of the page.
write_page() {
    awk -v part="$2" '/^<!-- end of what/ { skipping = 0 }
        !skipping { print }
        /^<!-- written by/ { while ((getline line < part) > 0) print line; skipping = 1 }' docs/performance.md >"$work/page"
    mv "$work/page" "$1"
}

draw() {
    mkdir -p "$1"
    local scene
    for scene in "${scenes[@]}"; do
        [[ -f $work/$scene.csv && -s $work/$scene.section ]] || continue
        gnuplot -c bench/work_precision/draw.gp "$work/$scene.csv" "$(sed -n 's/^### //p' "$work/$scene.section")" \
            "$1/$scene.png"
    done
}

for scene in "${scenes[@]}"; do
    [[ -f $work/$scene.csv ]] || publish=0
done
generated >"$work/generated.md"
draw "$work/performance"
write_page "$work/performance.md" "$work/generated.md"
if ((publish)); then
    mkdir -p docs/performance
    for scene in "${scenes[@]}"; do
        [[ ! -f $work/$scene.csv ]] || cp "$work/$scene.csv" docs/performance/
        [[ ! -f $work/performance/$scene.png ]] || cp "$work/performance/$scene.png" docs/performance/
    done
    cp "$work/performance.md" docs/performance.md
fi
printf 'The page is %s.\n' "$( ((publish)) && printf 'docs/performance.md' || printf '%s/performance.md' "$work")"
exit $status
