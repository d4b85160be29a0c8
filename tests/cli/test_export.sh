# shellcheck shell=bash
# deasim export: the deck runs unchanged in plain ngspice, and its results are ours.
# shellcheck source=tests/cli/deck.sh
source "$ROOT/tests/cli/deck.sh"

# export_and_run SCENE MAX_STEP [SET...]: our run at high accuracy, the deck in plain ngspice at tight settings.
export_and_run() {
    scene=$1
    local step=$2
    shift 2
    expect 0 "$DEASIM" export "$scene" -o deck.cir "$@"
    expect 0 "$DEASIM" run "$scene" "$@" --accuracy 1e-6 --set "output.formats=[csv]" -o run -q
    expect 0 ngspice -b deck.cir # prints a table, and is content
    # it finds its operating point at once
    if [ -s err ] && grep -iE 'gmin|singular|source step|Error' err; then echo "$scene: trouble in plain ngspice"; exit 1; fi
    tighten "$step"
    expect 0 ngspice -b -r deck.raw tight.cir
}

# a shorter step brings the deck closer: it converges to our result
for step in 80u 20u; do
    export_and_run "$ROOT/examples/rc_step.yaml" $step --set "transient.stop=20 ms"
    compare x 'v(pos)' >"difference-$step"
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
    within "$(compare x 'v(pos)')" 1e-3 x
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

# scene NAME STEP: the scene's text on standard input, on the actuator of the examples
scene() {
    { printf 'device:\n  base: %s/models/planar_c_s5.yaml\n' "$ROOT"; cat; printf 'transient: {stop: 20 ms}\n'; } >"$1.yaml"
    export_and_run "$1.yaml" "$2"
    within "$(compare x 'v(pos)')" 2e-4 x
    within "$(compare left.port_voltage 'v(left)')" 2e-4 left
}

# every waveform
scene chirp 10u <<'TEXT'
drive: {left: {waveform: {type: chirp, offset: 1 kV, amplitude: 800 V, from: 80 Hz, to: 300 Hz, delay: 2 ms, duration: 12 ms}, resistance: 10 MOhm}}
load: {type: chirp, amplitude: 10 mN, from: 50 Hz, to: 200 Hz, duration: 15 ms}
TEXT
scene sine 10u <<'TEXT'
drive: {left: {waveform: {type: sine, offset: 1 kV, amplitude: 800 V, frequency: 120 Hz, delay: 2 ms, phase: 40 deg, decay: 30}, resistance: 10 MOhm}}
load: {type: sine, amplitude: 10 mN, frequency: 100 Hz}
TEXT
scene trapezoids 10u <<'TEXT'
drive: {left: {waveform: {type: trapezoid, low: 200 V, high: 2 kV, delay: 1 ms, rise: 1 ms, flat: 2 ms, fall: 1 ms, gap: 3 ms}, resistance: 10 MOhm}}
TEXT
scene points 10u <<'TEXT'
drive: {left: {waveform: {type: pwl, points: [[1 ms, 0 V], [3 ms, 1 kV], [3 ms, 2 kV], [6 ms, 500 V], [7 ms, 0 V]], repeat: true}, resistance: 10 MOhm}}
TEXT

# amplifiers at each of their limits; the film's own resistance may be the only one
scene slewing 10u <<'TEXT'
drive:
  left: {waveform: {type: sine, offset: 1 kV, amplitude: 800 V, frequency: 300 Hz, delay: 1 ms}, amplifier: {slew_rate: 1 V/us, bandwidth: 2 kHz, output_resistance: 1 MOhm}}
  right: {waveform: {type: pulse, high: 1 kV, delay: 1 ms, width: 5 ms}, amplifier: {slew_rate: 0.5 V/us}, resistance: 1 MOhm}
TEXT
within "$(compare right.port_voltage 'v(right)')" 2e-4 right
scene limited 5u <<'TEXT'
  zones: {left: {electrode: {sheet_resistance: 50 kOhm/sq, feed: narrow_end}}, right: {electrode: {resistance: 200 kOhm}}}
  material: {dielectric: {conductivity: 1e-11 S/m, conductivity_field: 30 V/um}}
drive:
  left: {waveform: {type: sine, offset: 1 kV, amplitude: 800 V, frequency: 300 Hz, delay: 1 ms}, amplifier: {current_limit: 60 uA, bandwidth: 5 kHz}}
  right: {waveform: {type: pulse, high: 1 kV, delay: 1 ms}, amplifier: {current_limit: 20 uA}}
TEXT
within "$(compare right.port_voltage 'v(right)')" 2e-4 right

# every start
scene placed 10u <<'TEXT'
drive: {left: {waveform: {type: dc, level: 2.5 kV}, resistance: 10 MOhm}}
initial: {x: -0.2 mm, v: 0.1 m/s}
TEXT
scene thrown 1u <<'TEXT'
  platform: {damping: 0.02 N s/m, stops: [-0.3 mm, 0.3 mm], stop_stiffness: 50 kN/m, stop_loss: 3 s/m}
drive: {left: {waveform: {type: dc, level: 1.5 kV}, resistance: 10 MOhm}}
initial: {v: 0.6 m/s}
TEXT
scene pushed 2u <<'TEXT'
  platform: {mass: 0 g, damping: 0.5 N s/m, stops: [-0.1 mm, 0.1 mm], stop_stiffness: 5 kN/m, stop_loss: 100 s/m}
  options: {membrane_mass: false}
drive: {left: {waveform: {type: dc, level: 2.5 kV}, resistance: 10 MOhm}}
initial: {x: -0.2 mm}
TEXT
scene fresh 10u <<'TEXT'
  zones: {left: {length: 3 mm}}
drive: {left: {waveform: {type: sine, offset: 1 kV, amplitude: 800 V, frequency: 80 Hz}, resistance: 10 MOhm}}
initial: fresh
TEXT
scene fresh_network 10u <<'TEXT'
  zones: {left: {length: 3 mm}}
  material: {branches: [{kind: network, mu: 60 kPa, tau: 2 ms}]}
drive: {left: {waveform: {type: sine, offset: 1 kV, amplitude: 800 V, frequency: 80 Hz}, resistance: 10 MOhm}}
initial: fresh
TEXT

# without operating point: the film starts charged and at rest, the load acts at once
printf '%s\n' 'start from .ic' 'Vs s 0 PULSE(1000 2500 2m 1m 1m 10m 50m)' 'R1 s left 30Meg' 'C1 left 0 50p' 'R2 right 0 1Meg' \
    'Xdea left 0 right 0 pos DEA' '.ic v(left)=2k' '.tran 10u 20m uic' '.end' >uic.cir
scene charged 10u <<'TEXT'
drive: {netlist: uic.cir}
load: {type: sine, amplitude: 10 mN, frequency: 100 Hz}
TEXT
scene charged_thrown 10u <<'TEXT'
drive: {netlist: uic.cir}
initial: {x: 0.1 mm, v: 0.1 m/s}
TEXT

# a title is never a command
{ printf 'title: "*# shell touch owned"\n'; cat chirp.yaml; } >owned.yaml
export_and_run owned.yaml 20u
has deck.cir 'deasim: *# shell touch owned'
[ ! -e owned ] || { echo 'the title was run'; exit 1; }

# what plain ngspice cannot do is refused, and leaves no deck behind
{ printf 'device: %s/models/planar_c_s5.yaml\n' "$ROOT"; echo 'drive: {netlist: uic.cir}'; echo 'initial: fresh'; } >fresh.yaml
expect 2 "$DEASIM" export fresh.yaml -o none.cir
has err 'initial: fresh: plain ngspice finds where a fresh film rests in its operating point, which uic skips'
[ ! -e none.cir ] || { echo 'a deck is left behind'; exit 1; }
sed 's/^Xdea.*/&\nXdeb left2 0 right 0 pos2 DEA\nR3 left2 0 1Meg/' uic.cir >twins.cir
{ printf 'device: %s/models/planar_c_s5.yaml\n' "$ROOT"; echo 'drive: {netlist: twins.cir}'; } >twins.yaml
expect 2 "$DEASIM" export twins.yaml -o none.cir
has err 'xdea and xdeb start from different film voltages'
