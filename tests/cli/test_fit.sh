# shellcheck shell=bash
# deasim fit: sample tests through the program, what it prints can be read back as a material, pictures, refusals.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"
data=$ROOT/tests/data

expect 0 "$DEASIM" fit "$data/pull_pure_shear.csv" --lam2 2 --start free -o pull
has out 'gent, 61 points'
has out '  mu              364.3 kPa    95 % interval 363 kPa to 365.7 kPa'
has out '  jm              16.561       95 % interval 16.485 to 16.637'
head -c 4 pull/fit.png | tail -c 3 >magic
grep -q '^set offsets 0, 0, graph 0.04, graph 0.04$' pull/fit.gnuplot # the curve fills its frame
has magic PNG
has pull/fit.csv 'stretch [1],stress [Pa],fit [Pa]'
(($(wc -l <pull/fit.csv) == 62)) || exit 1

# every law's lines go into a material file as they are
for law in gent neo_hookean yeoh ogden arruda_boyce; do
    expect 0 "$DEASIM" fit "$data/pull_pure_shear.csv" --lam2 2 --start free --law $law
    cat >device.yaml <<END
geometry: {width: 30 mm, thickness: 33 um, prestretch: [1.2, 1.2]}
material:
  $(grep '^elastic:' out)
  dielectric: {permittivity: 2.5, breakdown: 100 V/um, conductivity: 0 S/m}
  density: 1120 kg/m^3
zones:
  left: {length: 4 mm, electrode: {resistance: 0 Ohm}}
  right: {length: 4 mm}
platform: {mass: 0.4 g, damping: 0 N s/m, load: 0 N}
END
    expect 0 "$DEASIM" static device.yaml --voltage 1000 --json
done

expect 0 "$DEASIM" fit --branches "$data/relaxation.csv" --mu "0.365 MPa" -o relaxation
has out 'relaxation, 120 points'
has out '  tau1            2.011 ms     95 % interval 1.958 ms to 2.067 ms'
has out '  - {kind: foo, mu: 29.2316 kPa, tau: 0.00201143 s}'
[[ -s relaxation/fit.png ]]
expect 0 "$DEASIM" fit --branches "$data/creep.csv" --json
has out '"model":"creep"'
has out '"ratio2":{"value":0.4998'
has out '"determined":true'
expect 0 "$DEASIM" fit --branches "$data/creep.csv" --count 4
has out 'the data do not carry that many parameters: take fewer branches'
expect 0 "$DEASIM" fit --help
has out 'usage: deasim fit'

refuse() { # MESSAGE ARGUMENT...
    local message=$1
    shift
    expect 2 "$DEASIM" fit "$@"
    has err "deasim fit: $message"
    [[ -s out ]] && { cat out; exit 1; }
    return 0
}
bad() { printf '%b' "$1" >bad.csv; }
refuse 'give one CSV file'
refuse 'missing.csv: cannot be opened: No such file or directory' missing.csv
bad 'stretch,stress\n1,2\n'
refuse "bad.csv:1: column 'stretch' lacks its unit; write it as \"name [unit]\"" bad.csv
bad 'stretch [1],stress [mm]\n1,2\n'
refuse "bad.csv:1: column 'stress': " bad.csv
bad 'stretch [1],stress [MPa]\n1,0\n1.1,0.1\nx,0.2\n'
refuse "bad.csv:4: the stretch 'x' is not a finite decimal number" bad.csv
bad 'stretch [1],stress [MPa]\n0,0\n1.1,0.1\n'
refuse 'bad.csv:2: the stretch 0 is not positive (strains must be given as 1 + strain)' bad.csv
bad 'stretch [1],stress [MPa]\n1,0\n1.1,0.1\n1.2,0.2\n'
refuse '3 points at 2 stretches are too few for the 2 parameters of a gent law; at least 4 are needed' bad.csv
bad 'time [s],stress [MPa]\n1,3\n1,2\n'
refuse 'bad.csv:3: the time 1 s does not follow 1 s' --branches bad.csv
bad 'time [s],stress [MPa]\n0,3\n'
refuse 'bad.csv:2: the time 0 s is not positive; times count from the step' --branches bad.csv
bad 'time [s],stress [MPa]\n1,3\n2,2\n3,-1\n'
refuse 'the stress must keep its sign and not be 0' --branches bad.csv
refuse "$ROOT/tests/data/relaxation.csv:3: the first column is 'time'; it must be \"stretch [unit]\"" "$ROOT/tests/data/relaxation.csv"
refuse '--law rubber: gent, neo_hookean, yeoh, ogden and arruda_boyce are allowed' bad.csv --law rubber
refuse '--count 9: 1 to 5 are allowed' --branches bad.csv --count 9
refuse '--stress real: nominal, clamped and true are allowed' bad.csv --stress real
refuse '--lam2 -1: must be positive' bad.csv --lam2 -1
refuse 'unknown option --nothing' bad.csv --nothing
