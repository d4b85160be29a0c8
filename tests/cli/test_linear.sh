# shellcheck shell=bash
# Linear circuits are solved together with the device; everything else falls back to ngspice by itself; both agree.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

# number NAME FILE: the number behind a key of the summary.
number() {
    grep -oE "\"$1\":[[:space:]]*-?[0-9.eE+-]+" "$2" | head -n 1 | sed 's/.*:[[:space:]]*//'
}

# close A B TOLERANCE: relative difference within the tolerance.
close() {
    awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN { d = a > b ? a - b : b - a; m = b < 0 ? -b : b; exit !(d <= t * m) }' && return 0
    printf '%s and %s differ by more than %s\n' "$1" "$2" "$3"
    exit 1
}

for scene in rc_step rc_ladder rlc rc_two_side_sine; do
    expect 0 "$DEASIM" run "$ROOT/examples/$scene.yaml" --json -q
    cp out linear.json
    has linear.json '"mode":	"linear"'
    expect 0 "$DEASIM" run "$ROOT/examples/$scene.yaml" --json -q --engine ngspice
    cp out cosim.json
    has cosim.json '"mode":	"cosim"'
    lacks linear.json 'null'
    close "$(number max linear.json)" "$(number max cosim.json)" 1e-3 # of x, the first signal
done
for measure in vpeak tring ipeak esupply; do
    expect 0 "$DEASIM" run "$ROOT/examples/rlc.yaml" --json -q
    cp out linear.json
    expect 0 "$DEASIM" run "$ROOT/examples/rlc.yaml" --json -q --engine ngspice
    close "$(number $measure linear.json)" "$(number $measure out)" 2e-3
done

# one nonlinear element is enough to fall back
scene() {
    printf 'device: %s/models/planar_c_s5.yaml\ndrive: {netlist: %s}\ntransient: {stop: 2 ms, accuracy: 1e-3}\n' "$ROOT" "$1" >scene.yaml
}
circuit() {
    {
        printf 'a title\nV1 s 0 PULSE(0 1000 0 10u 10u 1 2)\nR1 s left 1Meg\nXdea left 0 right 0 pos DEA\nR2 right 0 1k\n'
        printf '%s\n' "$@"
        printf '.tran 10u 2m\n.end\n'
    } >circuit.cir
    scene circuit.cir
}
circuit 'D1 left 0 DX' '.model DX D'
expect 0 "$DEASIM" run scene.yaml --json -q
has out '"mode":	"cosim"'
circuit 'B1 q 0 V=v(left)*v(left)'
expect 0 "$DEASIM" run scene.yaml --json -q
has out '"mode":	"cosim"'
# what listens to the position is coupled to the device
circuit 'E1 y 0 pos 0 2' 'R3 y 0 1k'
expect 0 "$DEASIM" run scene.yaml --json -q
has out '"mode":	"cosim"'
# subcircuits, parameters and every linear element
circuit '.param k=2' '.subckt arm a b r=1k' 'Ra a m {r*k}' 'Ca m b 1n' '.ends' 'Xa s 0 arm r=10k' 'L1 s o1 1' 'L2 o2 0 2' 'K1 L1 L2 0.9' \
    'Ro1 o1 0 1Meg' 'Ro2 o2 0 1k' 'E1 e 0 o2 0 2' 'Re e 0 1k' 'G1 e 0 o1 0 1u' 'F1 0 o1 V1 0.1' 'H1 h 0 V1 10' 'Rh h 0 1k' 'I1 0 o1 SIN(0 1u 1k)'
expect 0 "$DEASIM" run scene.yaml --json -q
has out '"mode":	"linear"'
cp out linear.json
expect 0 "$DEASIM" run scene.yaml --json -q --engine ngspice
close "$(number max linear.json)" "$(number max out)" 2e-3
# a measure that fails is null and a warning; of two nodes only PAR can be measured: here 1 kV 1 MOhm 82 pF over 2 ms
circuit '.measure tran never WHEN v(left)=9000' '.measure tran two AVG v(s,left)' ".measure tran par AVG par('v(s)-v(left)')"
for engine in auto ngspice; do
    expect 0 "$DEASIM" run scene.yaml --json --engine "$engine"
    jq -e '.measures.never == null and .measures.two == null and .measures.par > 40 and .measures.par < 43' out >tested
    has err '.measure tran never '
    has err '.measure tran two '
done
# a circuit of thousands of unknowns is left to ngspice
mapfile -t ladder < <(for ((i = 0; i < 2100; i++)); do printf 'Ra%d a%d a%d 1\n' "$i" "$i" $((i + 1)); done)
circuit "${ladder[@]}" 'Ra a0 s 1'
expect 0 "$DEASIM" run scene.yaml --json -q
has out '"mode":	"cosim"'
# a .measure line that ngspice's command language could take for more than a measure stays away from it
circuit ".measure tran m MAX par('v(left); shell touch executed')"
"$DEASIM" run scene.yaml --json -q >out 2>err || true # ngspice may refuse it, but not obey it
[ ! -e executed ] || { echo 'a .measure line ran a command'; exit 1; }
# plain netlists are read without ngspice, which reads them in a run that is given a time limit: no difference
for measure in vpeak tring ipeak esupply; do
    expect 0 "$DEASIM" run "$ROOT/examples/rlc.yaml" --json -q
    cp out plain.json
    expect 0 "$DEASIM" run "$ROOT/examples/rlc.yaml" --json -q --time-limit 100s
    has out '"mode":	"linear"'
    close "$(number $measure plain.json)" "$(number $measure out)" 1e-9
done
# .measure lines that only ngspice understands are evaluated by it, beside those that are not
circuit ".measure tran root MAX par('sqrt(v(s))')" '.measure tran peak MAX v(s)'
expect 0 "$DEASIM" run scene.yaml --json
has out '"mode":	"linear"'
jq -e '(.measures.root - 31.6228 | fabs) < 1e-4 and .measures.peak == 1000' out >tested
# a window the run never reaches has no average
circuit '.measure tran late AVG v(s) FROM=3m TO=4m'
expect 0 "$DEASIM" run scene.yaml --json
jq -e '.measures.late == null' out >tested
has err '.measure tran late failed'
