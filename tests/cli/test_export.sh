# shellcheck shell=bash
# deasim export: the deck runs unchanged in plain ngspice, and its results are ours.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

# compare COLUMN VECTOR SCALE: relative L2 difference of a column of run/result.csv and a vector of deck.raw, on the times of the former.
compare() {
    printf 'title\n.control\nset wr_singlescale\nload deck.raw\nwrdata vector.txt %s\n.endc\n.end\n' "$2" >load.cir
    ngspice -b load.cir >/dev/null 2>&1 || true
    awk -F, -v column="$1" -v scale="$3" '
        NR == FNR { split($0, w, " "); t[++n] = w[1]; v[n] = w[2] * scale; next }
        FNR == 1 { for (i = 1; i <= NF; i++) if (index($i, column " [") == 1) c = i; next }
        { while (k + 1 < n && t[k + 1] < $1) k++
          if (k < 1) k = 1
          p = t[k + 1] > t[k] ? ($1 - t[k]) / (t[k + 1] - t[k]) : 0
          d = $c - (v[k] + p * (v[k + 1] - v[k])); e += d * d; s += $c * $c }
        END { printf "%.3e\n", (s > 0 ? sqrt(e / s) : -1) }' vector.txt run/result.csv
}

# within VALUE LIMIT
within() {
    awk -v v="$1" -v l="$2" 'BEGIN { exit !(v >= 0 && v <= l) }' && return 0
    printf '%s: %s differs by %s, allowed %s\n' "$scene" "$3" "$1" "$2"
    exit 1
}

# export_and_run SCENE MAX_STEP [SET...]: our run at high accuracy, the deck in plain ngspice at tight settings.
export_and_run() {
    scene=$1
    local step=$2
    shift 2
    expect 0 "$DEASIM" export "$scene" -o deck.cir "$@"
    expect 0 "$DEASIM" run "$scene" "$@" --accuracy 1e-6 --set "output.formats=[csv]" -o run -q
    expect 0 ngspice -b deck.cir # prints a table, and is content
    sed -i -E "s/^(\.tran [^ ]+ [^ ]+ 0) [^ ]+/\1 $step/; s/^\.end\$/.options reltol=1e-5\n.end/" deck.cir
    expect 0 ngspice -b -r deck.raw deck.cir
}

for pair in bidirectional:10u rc_step:10u rc_ladder:20u bidirectional_half_bridge:50u; do
    export_and_run "$ROOT/examples/${pair%:*}.yaml" "${pair#*:}" --set "transient.stop=20 ms"
    within "$(compare x 'v(pos)' 1e-3)" 1e-3 x
    within "$(compare left.port_voltage 'v(left)' 1)" 1e-3 left
done

# a shorter step brings the deck closer: it converges to our result
for step in 80u 20u; do
    export_and_run "$ROOT/examples/rc_step.yaml" $step --set "transient.stop=20 ms"
    compare x 'v(pos)' 1e-3 >"difference-$step"
done
awk 'NR == FNR { coarse = $1; next } { exit !($1 < coarse / 3) }' difference-80u difference-20u ||
    { echo 'a quarter of the step does not bring the deck closer:'; cat difference-80u difference-20u; exit 1; }

# one device of everything else: laws, branches, losses, slack, loads, no mass
device() {
    printf 'device:\n  base: %s/models/planar_c_elastic.yaml\n' "$ROOT"
    printf '  %s\n' "$@"
}
drive='drive: {left: {waveform: {type: pulse, low: 0 V, high: 2500 V, delay: 1 ms, rise: 1 ms, width: 1 s}, resistance: 10 MOhm}}'
transient='transient: {stop: 12 ms}'
try() {
    local name=$1 step=$2
    shift 2
    { device "$@"; printf '%s\n%s\n' "$drive" "$transient"; } >"$name.yaml"
    export_and_run "$name.yaml" "$step"
    within "$(compare x 'v(pos)' 1e-3)" 1e-3 x
}
try yeoh 10u 'material: {elastic: {law: yeoh, c10: 180 kPa, c20: -10 kPa, c30: 6 kPa}}'
try ogden 10u 'material: {elastic: {law: ogden, terms: [{mu: 0.3 MPa, alpha: 2}, {mu: 5 kPa, alpha: 5}]}}'
try arruda_boyce 10u 'material: {elastic: {law: arruda_boyce, mu: 0.36 MPa, locking_stretch: 4}}'
try network 10u 'material: {branches: [{kind: network, mu: 60 kPa, tau: 2 ms}]}'
try leaky 10u 'material: {dielectric: {conductivity: 1e-11 S/m, conductivity_field: 30 V/um}}'
try sheet 10u 'zones: {left: {electrode: {sheet_resistance: 50 MOhm, feed: narrow_end}}}'
try viscous 10u 'platform: {mass: 0 g, damping: 0.5 N s/m}' 'options: {membrane_mass: false}'
try algebraic 10u 'platform: {mass: 0 g}' 'options: {membrane_mass: false}'
try loaded 10u 'platform: {load: 20 mN, stops: [-0.3 mm, 0.3 mm], stop_stiffness: 20 kN/m, stop_loss: 0 s/m}'
# weakly prestretched: both films go slack and come back
try slack 5u 'geometry: {prestretch: [1.03, 1.2]}'

# what plain ngspice cannot do is refused, and leaves no deck behind
printf 'device: %s/models/planar_c_elastic.yaml\ninitial: fresh\n%s\n%s\n' "$ROOT" "$drive" "$transient" >fresh.yaml
expect 2 "$DEASIM" export fresh.yaml -o none.cir
has err 'plain ngspice starts from the equilibrium only'
[ ! -e none.cir ] || { echo 'a deck is left behind'; exit 1; }
