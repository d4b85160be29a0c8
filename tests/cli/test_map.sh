# shellcheck shell=bash
# deasim map: the paper's figures as shipped, files, threads, devices, refusals.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

# without DEASIM it is the one that is installed
mkdir bin
ln -s "$DEASIM" bin/deasim
expect 0 env -u DEASIM PATH="$PWD/bin:$PATH" "$ROOT/examples/design/figure-5a.sh" -n 5 --no-picture
rm -r bin figure-5a

for figure in 5a 5b 6; do
    expect 0 "$ROOT/examples/design/figure-$figure.sh"
    mv out summary-$figure
    head -c 4 "figure-$figure/map.png" | tail -c 3 >magic
    has magic PNG
    (($(wc -l <"figure-$figure/map.csv") == 401 * 401 + 1)) || { wc -l "figure-$figure/map.csv"; exit 1; }
done
has summary-5a 'largest stretch 1.2949296'
has summary-5b 'largest displacement 0.06452432'
has summary-5b 'at r_a = 0.4677'
has summary-5b ', lp1 = 0.8836'
has summary-6 'largest displacement 0.06842872'
has summary-6 'at lp1 = 0.7919'
has summary-6 ', lp2 = 2.5560'
has figure-6/map.csv 'lp1 [1],lp2 [1],displacement [1],mode'

# the same bytes with one thread and with three
expect 0 "$DEASIM" map --x "E_bd=20 V/um:200 V/um" --y Jm=5:30 --of voltage -n 60x40 --threads 1 --no-picture -o one
has out 'largest voltage'
lacks out map.png
expect 0 "$DEASIM" map --x "E_bd=20 V/um:200 V/um" --y Jm=5:30 --of voltage -n 60x40 --threads 3 --no-picture -o three
cmp one/map.csv three/map.csv
[[ ! -e one/map.png ]]

# a device file is the base; other laws go the general way
expect 0 "$DEASIM" map "$ROOT/models/planar_unidirectional.yaml" --x lp1=1.1:1.3 --y lp2=1.1:1.3 -n 3x3 --no-picture -o device
grep -q '^1.2,1.2,0.0447716' device/map.csv || { cat device/map.csv; exit 1; }
expect 0 "$DEASIM" map "$ROOT/models/planar_unidirectional.yaml" --x lp1=1:1.3 --y r_a=0:1 -n 5 --of mode -o modes --dead-load
has out '25 designs:'
expect 0 "$DEASIM" map --x lp1=1:1.3 --y r_a=0.1:0.9 --designs 4 --max-voltage "1 kV" --no-picture --output supply
has out 'supply 100.0 %'
expect 0 "$DEASIM" map --help
has out 'usage: deasim map'

refuse() { # MESSAGE ARGUMENT...
    local message=$1
    shift
    expect 2 "$DEASIM" map "$@"
    has err "deasim map: $message"
    [[ -s out ]] && { cat out; exit 1; }
    return 0
}
refuse 'give --x PARAMETER=FIRST:LAST' --y lp1=1:2
refuse '--x: unknown parameter "lp"; r_a, lp1, lp2, E_bd, Jm, mu, eps_r and t0 are allowed' --x lp=0:1 --y lp1=1:2
refuse 'both axes are lp1' --x lp1=1:2 --y lp1=1:2
refuse '--x lp1=2:1: the range must grow' --x lp1=2:1 --y lp2=1:2
refuse '--x lp1=1: write lp1=FIRST:LAST' --x lp1=1 --y lp2=1:2
refuse '--x E_bd: ' --x "E_bd=1 mm:2 mm" --y lp2=1:2
refuse '--x lp1: 1e+300 is outside 0.05 .. 20; is the unit right?' --x lp1=1:1e300 --y lp2=1:2
refuse '--set t0: 2.5e+07 um is outside 0.01 .. 10000; is the unit right?' --x r_a=0:1 --y lp2=1:2 --set t0=25
refuse '--x lp1=1:2:3: write lp1=FIRST:LAST' --x lp1=1:2:3 --y lp2=1:2
refuse 'r_a = 2 is not possible; it must be between 0 and 1' --x r_a=1:2 --y lp2=1:2
refuse '-n 5x: write NXxNY, each from 2 to 20000' --x r_a=0:1 --y lp2=1:2 -n 5x
refuse '-n 1: write NXxNY' --x r_a=0:1 --y lp2=1:2 -n 1
refuse '--threads 0: 1 to 64 are allowed' --x r_a=0:1 --y lp2=1:2 --threads 0
refuse '--of size: displacement, stretch, voltage, stress1, stress2 and mode are allowed' --x r_a=0:1 --y lp2=1:2 --of size
refuse '--set lp2: write parameter=value' --x r_a=0:1 --y lp1=1:2 --set lp2
refuse '--max-voltage -1: must be positive' --x r_a=0:1 --y lp1=1:2 --max-voltage -1
refuse 'unknown option --nothing' --nothing
refuse 'a value is missing after --x' --x
