# shellcheck shell=bash
# deasim static: every row of the reference table through the program, sweeps, units, the three outputs, refusals.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

# device LP1 LP2 MU JM EPS_R E_BD T0 LEFT RIGHT: writes device.yaml (MPa, V/um, um, mm).
device() {
    cat >device.yaml <<END
geometry: {width: 30 mm, thickness: $7 um, prestretch: [$1, $2]}
material:
  elastic: {law: gent, mu: $3 MPa, jm: $4}
  dielectric: {permittivity: $5, breakdown: $6 V/um, conductivity: 0 S/m}
  density: 1120 kg/m^3
zones:
  left: {length: $8 mm, electrode: {resistance: 0 Ohm}}
  right: {length: $9 mm}
platform: {mass: 0.4 g, damping: 0 N s/m, load: 0 N}
options: {membrane_mass: true, slack: false}
END
}

# values FILE: the numbers of a JSON answer of one point, one "zone.key value" per line.
values() {
    tr '{},' '\n\n\n' <"$1" | awk -F: '
        /^"(left|right|limit)"/ { gsub(/"/, "", $1); place = $1 "."; next }
        NF == 2 && $2 != "" { gsub(/"/, ""); print place $1, $2 }
        /^$/ { next }'
}

# ---- the reference table ----
rows=0
while IFS=, read -r id kind mu jm eps ebd lp1 lp2 ratio t0 length voltage field l1a l1p _ _ s1a s2a s1p s2p c mode \
    stretch_max d_max v_max e_max _; do
    [[ $id =~ ^[0-9]+$ && $mode != PRE_RUPT ]] || continue
    left=$(awk "BEGIN { printf \"%.17g\", $ratio * $length }")
    right=$(awk "BEGIN { printf \"%.17g\", $length - $ratio * $length }")
    device "$lp1" "$lp2" "$mu" "$jm" "$eps" "$ebd" "$t0" "$left" "$right"
    if [[ $kind == MAX ]]; then # its stresses need more digits of the voltage than the table has: those of the limit
        expect 0 "$DEASIM" static device.yaml --voltage 0 --json
        voltage=$(values out | awk '$1 == "limit.voltage" { print $2 }')
    fi
    expect 0 "$DEASIM" static device.yaml --voltage "$voltage" --json
    values out >values
    awk -v id="$id" -v mode="$mode" -v mu="$mu" -v field="$field" -v l1a="$l1a" -v l1p="$l1p" -v s1a="$s1a" -v s2a="$s2a" \
        -v s1p="$s1p" -v s2p="$s2p" -v c="$c" -v stretch_max="$stretch_max" -v d_max="$d_max" -v v_max="$v_max" \
        -v e_max="$e_max" -v length_mm="$length" '
        function near(what, ours, wanted, scale) {
            error = ours - wanted; error = error < 0 ? -error : error
            size = wanted < 0 ? -wanted : wanted
            if (error <= 1e-8 * (size > scale ? size : scale)) return
            printf "row %s, %s: %.12g, expected %.12g\n", id, what, ours, wanted; bad = 1
        }
        { v[$1] = $2 }
        END {
            near("stretch left", v["left.stretch"], l1a, 0); near("stretch right", v["right.stretch"], l1p, 0)
            near("field", v["left.true_field"] / 1e6, field, 1)
            near("stress1 left", v["left.stress1"] / 1e6, s1a, mu); near("stress2 left", v["left.stress2"] / 1e6, s2a, mu)
            near("stress1 right", v["right.stress1"] / 1e6, s1p, mu); near("stress2 right", v["right.stress2"] / 1e6, s2p, mu)
            near("capacitance", v["left.capacitance"] / 30e-3 * 1e9, c, 0)
            name["BD"] = "breakdown"; name["LT1"] = "slack1"; name["LT2"] = "slack2"; name["PRE_LT1"] = "prestretch"
            if (v["limit.mode"] != name[mode]) { printf "row %s: mode %s\n", id, v["limit.mode"]; bad = 1 }
            if (mode == "PRE_LT1") {
                if (v["limit.voltage"] v["limit.x"] v["limit.stretch"] v["limit.true_field"] != "nullnullnullnull") {
                    printf "row %s: limit has numbers\n", id; bad = 1
                }
            } else {
                near("largest stretch", v["limit.stretch"], stretch_max, 0)
                near("largest d", v["limit.x"] / length_mm * 1e3, d_max, 0)
                near("largest voltage", v["limit.voltage"], v_max, 0)
                near("largest field", v["limit.true_field"] / 1e6, e_max, 0)
            }
            exit bad
        }' values
    rows=$((rows + 1))
done <"$ROOT/tests/data/static.csv"
((rows == 114)) || { echo "$rows rows were compared"; exit 1; }

# ---- sweeps and units ----
device 1.2 1.2 0.365 16.6 2.5 100 33 4 4
expect 0 "$DEASIM" static device.yaml --voltage 0:4kV:5 --csv
(($(wc -l <out) == 6)) || { cat out; exit 1; }
has out 'voltage [V],x [m],left.stretch [1],left.true_field [V/m],left.stress1 [Pa],left.stress2 [Pa],left.tension [N]'
cut -d, -f1 out | tail -n +2 | paste -sd' ' >voltages
has voltages '0 1000 2000 3000 4000'
cut -d, -f16 out | tail -n +2 | paste -sd' ' >beyond
has beyond '0 0 0 0 1'
expect 0 "$DEASIM" static device.yaml -V "3.3 kV"
has out '3.3000    429.583'
has out 'First failure of the left drive: dielectric breakdown'
has out 'at 3.0288 kV, x 358.173 um, stretch lam1/lp1 1.089543, true field 100.000 V/um'
expect 0 "$DEASIM" static device.yaml --field "100 V/um"
has out '3.0288    358.173'
expect 0 "$DEASIM" static device.yaml --voltage=-2000 --set geometry.prestretch='[1, 2.2]'
has out '  -2.0000'
expect 0 "$DEASIM" static --help
has out 'usage: deasim static DEVICE'

# what nobody means
refuse() { # MESSAGE ARGUMENT...
    local message=$1
    shift
    expect 2 "$DEASIM" static device.yaml "$@"
    has err "deasim static: $message"
    [[ ! -s out ]]
}
refuse "--voltage: up to 100000 V either way is allowed; is the unit right?" --voltage 1e300
refuse "--voltage: up to 100000 V either way" --voltage "0:4 MV:3"
refuse "--field: up to 1e+10 V/m either way is allowed" --field "1e5 V/um"
refuse "--right-voltage: up to 100000 V either way" --voltage 0 --right-voltage=-1e6

# a right zone under voltage, and one that cannot be
expect 2 "$DEASIM" static device.yaml --voltage 1000 --right-voltage 500
has err 'deasim static: zones.right carries no electrode, it cannot be at 500 V'
lacks out '{'

# a prestretch beyond the law: no equilibrium is an answer, not a failure
device 1 4.4 0.365 16.6 2.5 100 25 4 4
expect 0 "$DEASIM" static device.yaml --voltage 0 --json
has out '{"voltage":0,"x":null,"zones":null,"stable":false,"beyond":true}'
has out '"limit":{"mode":"prestretch","voltage":null,"x":null,"stretch":null,"true_field":null}'
expect 0 "$DEASIM" static device.yaml --voltage 0
has out 'the prestretch is beyond the limit of the elastic law'

# ---- refusals ----
refuse() { # MESSAGE ARGUMENT...
    local message=$1
    shift
    expect 2 "$DEASIM" static "$@"
    has err "deasim static: $message"
    [[ -s out ]] && { cat out; exit 1; }
    return 0
}
refuse 'no device file given' --voltage 3
refuse 'give either --voltage or --field' device.yaml
refuse 'give either --voltage or --field' device.yaml --voltage 1 --field 1
refuse 'give either --csv or --json' device.yaml --voltage 1 --csv --json
refuse '"more" is one argument too many' device.yaml more --voltage 1
refuse 'unknown option --volts' device.yaml --volts 1
refuse 'a value is missing after --voltage, see deasim static --help' device.yaml --voltage
refuse '--voltage: "0:1" lacks the number of points, first:last:count' device.yaml --voltage 0:1
refuse '--voltage: "1" is not a number of points; 2 to 1000000 are allowed' device.yaml --voltage 0:1:1
refuse '--voltage: "0:1:2:3" is neither a value nor first:last:count' device.yaml --voltage 0:1:2:3
refuse '--voltage: ' device.yaml --voltage '3 mm'
refuse '--field: ' device.yaml --field 'nan'
refuse '--right-voltage: ' device.yaml --voltage 1 --right-voltage x
expect 2 "$DEASIM" static missing.yaml --voltage 1
has err 'missing.yaml'
