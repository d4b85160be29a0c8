# shellcheck shell=bash
# What deasim says to input it cannot use: the place, the mistake, what is allowed; exit code 2, nothing on stdout, and no
# file of a result.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

cat >scene.yaml <<END
title: Good
device: $ROOT/models/planar_c_s5.yaml
drive:
  left: {waveform: {type: pulse, high: 2 kV, delay: 1 ms, rise: 100 us}, resistance: 1 MOhm}
transient: {stop: 5 ms}
END
expect 0 "$DEASIM" check scene.yaml
unidirectional=(--set "device=$ROOT/models/planar_unidirectional.yaml")

tried=0
# refused MESSAGE ARGUMENT...: run, check and test refuse the scene with this message; run leaves nothing behind.
refused() {
    local message=$1 command
    shift
    [[ $1 == -* ]] && set -- scene.yaml "$@"
    rm -rf out.d
    expect 2 "$DEASIM" run -o out.d "$@"
    has err "$message"
    lacks err "internal"
    [[ ! -s out ]] || { cat out; exit 1; }
    [[ ! -e out.d ]] || { echo "left behind: $(ls -d out.d out.d/*)"; exit 1; }
    expect 2 "$DEASIM" check "$@"
    has err "$message"
    expect 2 "$DEASIM" test "$@"
    has err "$message"
    has out "0 passed, 1 failed"
    tried=$((tried + 1))
}

# one KEY VALUE MESSAGE: the same for one key given on the command line, which the message names.
one() {
    refused "$3" --set "$1=$2"
    has err "--set $1=$2: "
    has err "${1##*.}: "
}

# ---- units and numbers ----
one transient.stop '5 mm' "unit 'mm' is not that of a time; allowed: ns, us, ms, s, min, h"
one transient.stop '5 sec.' "unknown unit 'sec.'"
one transient.stop '500 Ms' "5e+08 s is outside 1 ns .. "
one transient.stop 0 "0 s is not positive; allowed: 1 ns .. "
one transient.stop '-1 ms' "-1 ms is not positive"
one transient.stop nan "'nan' is not a finite number"
one transient.stop inf "'inf' is not a finite number"
one transient.stop 1e400 "is too large a number"
one transient.stop '1,5 ms' "',' is not allowed in a number; use a decimal point"
one transient.stop soon "'soon' is not a number with a unit"
one transient.stop '[1, 2]' "expected a time, found a list"
one transient.stop '1 ps' "1 ps is outside 1 ns .. "
one transient.accuracy 1 "1 is outside 1e-12 .. 0.1"
one transient.max_step '-1 us' "not positive"
one device.geometry.width '-30 mm' "-30 mm is not positive; allowed: 1 um .. 1 m"
one device.geometry.width 30 "30 m is outside 1 um .. 1 m; is the unit missing?"
one device.geometry.width '30 M' "'M' alone is not a unit (a SPICE suffix is not read here)"
one device.geometry.thickness '0 um' "0 m is not positive"
one device.geometry.prestretch '[1.2]' "expected a list of two, found 1 entry"
one device.geometry.prestretch 1.2 "expected a list of two, found"
one device.zones.left.length '-4 mm' "-4 mm is not positive"
one device.zones.left.length '4 kg' "unit 'kg' is not that of a length"
one device.platform.mass '-1 g' "-1 g is negative; allowed: 0 or "
one device.platform.damping '1 N/m' "unit 'N/m' is not that of a damping"
one device.platform.load '1 kN' "is outside"
one device.platform.stops '[0.2 mm, -0.2 mm]' "the stops must lie on both sides of x = 0, the lower one first"
one device.options.slack maybe "expected true or false, found 'maybe'"
one drive.left.resistance '-1 MOhm' "negative; allowed: 0 or"
one drive.left.resistance '1 MV' "unit 'MV' is not that of a resistance"
one output.sample '1 s' "the sample time 1 s is longer than the run, 0.005 s"
one output.sample '1 fs' "1 fs is outside"
one output.sample '10 ps' "the run would write 5e+08 rows; at most 1e+08 are allowed"

# ---- a file of another kind ----
expect 2 "$DEASIM" check "$ROOT/models/planar_c_s5.yaml"
has err "planar_c_s5.yaml:3:1: this is a device, not a scene; a scene names it as its device"
expect 2 "$DEASIM" static "$ROOT/examples/rlc.yaml" --voltage 0
has err "rlc.yaml:1:1: this is a scene, not a device; give the file it names as its device"

# ---- keys, types, choices ----
refused "unknown key 'transiant'; did you mean 'transient'? allowed: title, device," --set transiant.stop=1
refused "unknown key 'widht'; did you mean 'width'? allowed: width, thickness, prestretch" --set device.geometry.widht=1
refused "unknown key 'resitance'; did you mean 'resistance'?" --set drive.left.resitance=1
refused "unknown key 'centre'; allowed: left, right" --set device.zones.centre.length=1
refused "the key 'stop' is missing" --set transient.stop=null
refused "the key 'transient' is missing" --set transient=null
refused "unknown key 'nothing'; allowed: title, device," --set nothing.here=null
refused "the key 'drive' of a scene is missing (drive: {} grounds every electrode)" --set drive=null
refused "the key 'device' of a scene is missing" --set device=null
refused "the key 'width' of a geometry is missing" --set device.geometry.width=null
refused "the key 'length' of a zone is missing" --set device.zones.left.length=null
refused "a device needs at least one zone; allowed: left, right" --set 'device.zones={}'
refused "the key 'dielectric' of a material is missing" --set device.material.dielectric=null
one transient 5 "expected a transient as a mapping, found '5'; keys: stop, accuracy, max_step"
one events.breakdown explode "expected one of the allowed words, found 'explode'; allowed: ignore, warn, stop, short"
one events.slack short "only breakdown can be a short; allowed: ignore, warn, stop"
one initial stale "expected one of the allowed words, found 'stale'; allowed: equilibrium, fresh"
one output.formats csv "expected a list of formats, found 'csv'"
refused "the scene has no signal 'left.volts'; did you mean 'left.voltage'?" --set 'output.signals=[left.volts]'
refused "signal 'x' is already in the list" --set 'output.signals=[x, x]'

# ---- materials ----
one device.material.elastic.law goo "expected one of the allowed words, found 'goo'; allowed: gent, neo_hookean, yeoh, ogden, arruda_boyce"
one device.material.elastic.mu '0.365' "0.365 Pa is outside 100 Pa .. 1 GPa; is the unit missing?"
one device.material.elastic.jm -5 "-5 is not positive"
one device.material.branches '{}' "expected a list of branches"
refused "tau" --set 'device.material.branches=[{kind: foo, mu: 1 kPa, tau: 0 s}]'
refused "a network branch has no jm" --set 'device.material.branches=[{kind: network, mu: 1 kPa, tau: 1 s, jm: 5}]'
one device.material.dielectric.permittivity 0 "0 is not positive"
refused "the permittivity at the prestretch 1.2 is -0.5" --set device.material.dielectric.permittivity_slope=-2.5
one device.material.density '1 g/cm' "unit 'g/cm' is not that of a density"

# ---- prestretch that has failed: not run, but an answer of the static model ----
# grey zones: lp1 <= lp2^-1/2, lp2 <= lp1^-1/2, D = Jm + 3 - I1 <= 0
for pair in '[0.8, 1.2]' '[1.2, 0.8]' '[4.4, 1.2]'; do
    refused "cannot be run: the prestretch " --set "device.geometry.prestretch=$pair"
    expect 0 "$DEASIM" static "$ROOT/models/planar_c_s5.yaml" --voltage 100 --json --set "geometry.prestretch=$pair"
    jq -e '.limit == {"mode": "prestretch", "voltage": null, "x": null, "stretch": null, "true_field": null}' out >tested
done

# ---- drives ----
one drive.left.waveform.type squarish "expected one of the allowed words, found 'squarish'; allowed: dc, pulse, pwl, sine, chirp, trapezoid, file"
one drive.left.waveform '{high: 1 kV}' "the key 'type' of a waveform is missing"
one drive.left.waveform '{type: pulse}' "the key 'high' of a pulse waveform is missing"
one drive.left.waveform '{type: pulse, high: 1 kV, width: 2 ms, period: 1 ms}' "pulse: period 0.001 s is shorter than rise + width + fall = 0.002 s"
one drive.left.waveform '{type: pulse, high: 1 kV, period: 1 ms}' "the key 'width' of a pulse with a period is missing"
one drive.left.waveform '{type: pulse, high: 1 kV, width: 0}' "pulse: rise, width and fall are all 0, so it never leaves low"
refused "200 kV is outside -100 kV .. 100 kV" --set 'drive.left.waveform={type: dc, level: 200 kV}'
refused "the key 'frequency' of a sine waveform is missing" --set 'drive.left.waveform={type: sine, amplitude: 1 kV}'
refused "goes back behind" --set 'drive.left.waveform={type: pwl, points: [[0 s, 0 V], [2 ms, 1 kV], [1 ms, 0 V]]}'
refused "have the same time 0.001 s; two make a jump" --set 'drive.left.waveform={type: pwl, points: [[1 ms, 0], [1 ms, 1], [1 ms, 2]]}'
refused "expected a list of two, found 1 entry" --set 'drive.left.waveform={type: pwl, points: [[0 s]]}'
refused "to repeat, its last point must be later than its first" --set 'drive.left.waveform={type: pwl, points: [[0, 1]], repeat: true}'
refused "give either period or gap, not both" --set 'drive.left.waveform={type: trapezoid, high: 1, rise: 1ms, flat: 1 ms, fall: 1 ms, gap: 1 ms, period: 9 ms}'
refused "is shorter than rise + flat + fall" --set 'drive.left.waveform={type: trapezoid, high: 1, rise: 1ms, flat: 1 ms, fall: 1 ms, period: 2 ms}'
refused "an amplifier needs a resistance in series: give output_resistance" --set drive.left.resistance=0 --set 'drive.left.amplifier={current_limit: 1 mA}'
refused "drive.left.amplifier: an amplifier needs a resistance in series" --set drive.left.resistance=0 --set 'drive.left.amplifier={bandwidth: 1 kHz}'
refused "events.breakdown: a short needs a resistance in drive.left or its electrode" --set drive.left.resistance=0 --set events.breakdown=short
refused "the right zone is passive: it has no electrode to drive" "${unidirectional[@]}" --set 'drive.right={waveform: {type: dc, level: 0 V}}'
refused "the device has no right zone" --set device.zones.right=null --set 'drive.right={waveform: {type: dc, level: 0 V}}'
refused "a native source besides a netlist; give one or the other" --set drive.netlist="$ROOT/netlists/rc_step.cir"
refused "cannot read nowhere.cir: No such file or directory" --set 'drive={netlist: nowhere.cir}'
refused "it is a directory" --set "drive={netlist: $ROOT}"
refused "unit 'V' is not that of a force" --set 'load={type: dc, level: 5 V}'

refused "7.5e+08 periods in the run; at most 1e+08 are allowed" \
    --set 'drive.left.waveform={type: pulse, high: 1 kV, width: 1 ps, period: 4 ps, delay: 2 ms}'
refused "5e+09 periods in the run" --set 'transient.stop=5 s' --set 'drive.left.waveform={type: sine, amplitude: 1 kV, frequency: 1 GHz}'
refused "periods in the run" --set 'load={type: pwl, points: [[0 s, 0 N], [1 fs, 1 N]], repeat: true}'
refused "initial.x: 4 mm leaves the right zone no length; it has 4 mm at x = 0" --set 'initial={x: 4 mm}'
refused "initial.x: -1 m leaves the left zone no length; it has 4 mm at x = 0" --set 'initial={x: -1 m}'

refused "initial.v: has no effect: platform and membrane have no mass" --set 'initial={v: 1 m/s}' \
    --set device.platform.mass=0 --set device.options.membrane_mass=false

# ---- waveform files ----
csv() { # MESSAGE, the file on stdin
    cat >wave.csv
    refused "$1" --set 'drive.left.waveform={type: file, path: wave.csv}'
}
refused "No such file or directory" --set 'drive.left.waveform={type: file, path: nowhere.csv}'
csv "wave.csv:1: " <<<$'time, voltage\n0, 0\n1, 1'
csv "wave.csv:3: " <<<$'time [ms], u [V]\n0, 0\n1'
csv "wave.csv:3: " <<<$'time [ms], u [V]\n0, 0\n\n2, 1'
csv "wave.csv:4: " <<<$'time [ms], u [V]\n0, 0\n2, 1\n1, 0'
csv "wave.csv:3: " <<<$'time [ms], u [V]\n0, 0\n1, nan'
csv "wave.csv:1: " <<<$'time [ms], u [mm]\n0, 0\n1, 1'
csv "wave.csv" <<<$'time [ms], u [V]\n0, 0'
csv "wave.csv" </dev/null

# ---- expectations ----
refused "an expectation needs a bound: above, below or both" --set 'expect=[{signal: x, measure: max}]'
refused "nothing lies above 2 and below 1" --set 'expect=[{signal: x, measure: max, above: 2 m, below: 1 m}]'
refused "without a netlist there is no .measure 'peak'; give a signal" --set 'expect=[{measure: peak, above: 0}]'
refused "measure 'max' needs the key 'signal'" --set 'expect=[{measure: max, above: 0}]'
refused "unit 'V' is not that of a length" --set 'expect=[{signal: x, measure: max, above: 0 V}]'

# ---- files: missing, empty, in a circle, not YAML ----
refused "cannot read nowhere.yaml: No such file or directory" nowhere.yaml
refused "it is a directory" "$ROOT"
: >empty.yaml
refused "cannot read empty.yaml: it is empty" empty.yaml
echo '# nothing' >comment.yaml
refused "comment.yaml: holds no keys" comment.yaml
printf 'title: x\n  device: y\n' >indented.yaml
refused "indented.yaml:2:" indented.yaml
printf '\t- a' >tab.yaml
refused "tab.yaml:1:" tab.yaml
head -c 5000 /dev/urandom >random.yaml
refused "random.yaml" random.yaml
printf 'title: a\ntitle: b\n' >twice.yaml
refused "twice.yaml:2:1: " twice.yaml
echo 'base: b.yaml' >a.yaml
echo 'base: a.yaml' >b.yaml
refused "circular reference: a.yaml -> b.yaml -> a.yaml" a.yaml
sed 's|^device:.*|device: scene2.yaml|' scene.yaml >scene2.yaml
refused "circular reference: scene2.yaml -> scene2.yaml" scene2.yaml
sed 's|^device:.*|device: nowhere.yaml|' scene.yaml >lost.yaml
refused "lost.yaml:2:9: device: cannot read nowhere.yaml: No such file or directory" lost.yaml
has err "    2 | device: nowhere.yaml"
has err "      |         ^"
sed 's|^device:.*|device: {base: '"$ROOT"'/models/planar_c_s5.yaml, material: nowhere.yaml}|' scene.yaml >lost.yaml
refused "device.material: cannot read nowhere.yaml: No such file or directory" lost.yaml
printf 'a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\nd: &d [*c, *c]\ntitle: *d\n' >bombs.yaml
refused "bombs.yaml" bombs.yaml
printf 'title: %s\n' "$(head -c 100000 /dev/zero | tr '\0' '[')" >deep.yaml
refused "deep.yaml" deep.yaml

echo "$tried refusals"
