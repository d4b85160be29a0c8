# shellcheck shell=bash
# deasim optimum: the table of the paper's design study through the program, options, refusals.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

# number KEY: the first number of that name in the JSON answer.
number() { sed 's/[,{]/\n/g' out | sed -n "s/^\"$1\"://p" | head -n 1 | tr -d '}'; }

# near KEY VALUE UNIT: half a unit of the last digit given.
near() {
    awk -v ours="$(number "$1")" -v wanted="$2" -v unit="$3" -v key="$1" 'BEGIN {
        error = ours - wanted; error = error < 0 ? -error : error
        if (ours == "" || error > 0.5000001 * unit) { printf "%s: %s, expected %s\n", key, ours, wanted; exit 1 } }'
}

expect 0 "$DEASIM" optimum --json
near stroke 0.0645243 1e-7
near r_a 0.467738 1e-6
near lp1 0.883642 1e-6
near stretch 1.137950 1e-6
near voltage 2196.934 1e-3
has out '"method":"closed form"'

expect 0 "$DEASIM" optimum --free none --set r_a=0.46 --set lp1=0.88 --set lp2=2 --json
near displacement 0.0645081 1e-7
near stretch 1.140235 1e-6
near voltage 2192.530 1e-3
has out '"method":"given"'

expect 0 "$DEASIM" optimum --both-ways --json
near stroke 0.128514 1e-6
near lp1 0.891031 1e-6

expect 0 "$DEASIM" optimum --free lp1,lp2 --json
near stroke 0.0684287 1e-7
near lp1 0.791969 1e-6
near lp2 2.556039 1e-6

expect 0 "$DEASIM" optimum --free none --set lp1=0.76 --set lp2=2.48 --json
near stroke 0.0678928 1e-7

expect 0 "$DEASIM" optimum --free lp2 --pure-shear --json
near stroke 0.0629325 1e-7
near lp2 2.180543 1e-6
has out '"method":"search"'

expect 0 "$DEASIM" optimum --dead-load --json
near stretch 1.294930 1e-6
near lp1 0.776521 1e-6

expect 0 "$DEASIM" optimum --compare
has out 'the passive membrane costs a factor of 2.1379 in stretch - 1; 2.2949 at r_a 0.5'
has out 'stroke / total length 0.1285136 (+-0.0642568) at lp1 0.891031, lp2 2 (breakdown)'
has out '  r_a    0.4677378  (chosen)'

expect 0 "$DEASIM" optimum --free lp1,lp2 --over Jm=5:30:6
(($(wc -l <out) == 8)) || { cat out; exit 1; }
grep -q '^        10  0.500000  0.845181  2.081666 .*   2.009829   2.081666$' out || { cat out; exit 1; }
expect 0 "$DEASIM" optimum --over "E_bd=50 V/um:150 V/um:3" --json
has out '"over":"E_bd"'

expect 0 "$DEASIM" optimum --free r_a,lp1,t0 --max-voltage "1 kV" --json
near stroke 0.0645243 1e-7
near t0 11.3795e-6 1e-10
expect 0 "$DEASIM" optimum --free r_a,lp1=1:1.5
has out '  lp1    1  (chosen), at the end of its range'
expect 0 "$DEASIM" optimum "$ROOT/models/planar_unidirectional.yaml" --free none --json
near displacement 0.0447716 1e-7
sed "s#^base: .*#base: $ROOT/models/planar_c_s5.yaml\nmaterial: $ROOT/models/materials/elastosil2030.yaml#" \
    "$ROOT/models/planar_unidirectional.yaml" >elastosil.yaml
expect 0 "$DEASIM" optimum elastosil.yaml --free r_a,lp1 # Yeoh, permittivity falling with stretch, no breakdown given
has out '  E_bd   not given'
has out '(search)'
expect 0 "$DEASIM" optimum --min-tension "120 kPa" --json
near passive_stress1 120000 1e-3

# ---- switched on: the undamped step against its energy balance, the measured device of the paper ----
expect 0 "$DEASIM" optimum --dynamic --free none --set lp1=1.2 --set lp2=1.2
has out 'step: displacement peaks at 1.97'
has out 'ramp of one period: displacement peaks at 1.34'
has out 'breakdown after'
expect 0 "$DEASIM" optimum --dynamic --free none --set lp1=1.2 --set lp2=1.2 --json
has out '"first_failure":"breakdown"'
sed 's/.*"step"/"step"/' out >step
mv step out
# at the largest safe step the peak field is E_bd, and the work of the source has all become energy:
# r W(lam_a) + (1 - r) W(lam_p) - W(lp) = (eps/2) r (V/t0)^2 ((lam_a/lp1)^2 - 1)
awk -v volt="$(number safe_voltage)" 'function w(l1, l2) {
        return -0.365e6 * 16.6 / 2 * log(1 - (l1 * l1 + l2 * l2 + 1 / (l1 * l1 * l2 * l2) - 3) / 16.6) }
    function missing(v) {
        r = 0.5; lp1 = 1.2; la = 100e6 * 25e-6 * lp1 / v; lp = lp1 - r / (1 - r) * (la - lp1)
        return r * w(la, 1.2) + (1 - r) * w(lp, 1.2) - w(lp1, 1.2) - 2.5 * 8.8541878128e-12 / 2 * r * (v / 25e-6) ^ 2 * ((la / lp1) ^ 2 - 1) }
    BEGIN { if (missing(volt * 0.9998) > 0 && missing(volt * 1.0001) < 0) exit 0; print "safe voltage", volt; exit 1 }'
expect 0 "$DEASIM" optimum "$ROOT/models/planar_c_s5.yaml" --dynamic --json
has out '"safe_voltage":'
expect 0 "$DEASIM" optimum --dynamic --max-voltage "1 kV"
has out '; no failure'

expect 0 "$DEASIM" optimum --help
has out 'usage: deasim optimum'

refuse() { # MESSAGE ARGUMENT...
    local message=$1
    shift
    expect 2 "$DEASIM" optimum "$@"
    has err "deasim optimum: $message"
    [[ -s out ]] && { cat out; exit 1; }
    return 0
}
refuse '--free: unknown parameter "lp3"' --free r_a,lp3
refuse '--free lp1=2: write lp1=FIRST:LAST' --free lp1=2
refuse '--over t0: 2.5e+07 um is outside 0.01 .. 10000; is the unit right?' --over t0=25:50:4
refuse '--set mu: 1e-36 MPa is outside 0.0001 .. 1000; is the unit right?' --set mu=1e-30
refuse 'the range of lp1 is empty' --free lp1=2:1
refuse 'with --pure-shear lp1 is 1 and cannot be free' --free lp1 --pure-shear
refuse 'with a dead load there is no r_a to choose' --free r_a --dead-load
refuse 'a dead load cannot be driven the other way' --dead-load --both-ways
refuse 'the thickness matters only when the supply is limited' --free t0
refuse 'mu is a property of the material; give it a range to choose from' --free mu
refuse 'this design fails by its prestretch alone' --free none --set lp1=0.6
refuse 'no design in these ranges survives its prestretch' --free lp1=0.2:0.5
refuse '--over Jm: it cannot be free as well' --free Jm=5:10 --over Jm=5:30:6
refuse '--over Jm: "5:30" lacks the number of points' --over Jm=5:30
refuse '--over goes neither with --compare nor with --dynamic' --over Jm=5:30:3 --compare
refuse 'a dead load has no natural frequency to switch on against' --dead-load --dynamic
refuse '--min-tension -1: must not be negative' --min-tension -1
refuse '--min-tension: ' --min-tension '3 mm'
refuse 'unknown option --nothing' --nothing
