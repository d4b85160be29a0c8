# shellcheck shell=bash
# result.raw in the ngspice program: it loads, its numbers are those of the CSV, it prints, measures and plots; result.h5
# holds the same, where h5dump is there to see.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

cat >scene.yaml <<END
title: Both sides
device: $ROOT/models/planar_c_s5.yaml
drive:
  left: {waveform: {type: pulse, high: 2 kV, delay: 1 ms, rise: 100 us}, resistance: 1 MOhm}
  right: {waveform: {type: sine, offset: 500 V, amplitude: 300 V, frequency: 90 Hz}, resistance: 10 MOhm}
transient: {stop: 30.05 ms}
output: {sample: 0.1 ms, formats: [csv, raw, hdf5]}
END
expect 0 "$DEASIM" run scene.yaml -o run
signals=$(head -n 1 run/result.csv | sed 's/ \[[^]]*\]//g; s/^time,//; s/,/ /g')
cat >look.cir <<END
a look at a result
.control
set numdgt=15
set wr_singlescale
set wr_vecnames
load run/result.raw
display
print maximum(left.voltage) length(x)
meas tran peak max left.voltage
wrdata table $signals
set hcopydevtype=svg
hardcopy picture.svg x left.voltage
quit
.endc
.end
END
expect 0 ngspice -n -b look.cir
cat out err >said
has said "Title: Both sides"
has said "length(x) = 3.020000000000000e+02" # 0 .. 30 ms, and the end at 30.05 ms
has picture.svg "</svg>"

# every cell, to the twelve digits of the CSV
awk 'NR == FNR { if (FNR > 1) for (i = 1; i <= NF; i++) theirs[FNR, i] = $i; rows = FNR; next }
    FNR == 1 { split($0, names, ",") }
    FNR > 1 { for (i = 1; i <= NF; i++) {
        gap = $i - theirs[FNR, i]; size = $i < 0 ? -$i : $i
        if (!((FNR, i) in theirs) || gap > 5.1e-12 * size || -gap > 5.1e-12 * size) {
            printf "row %d, %s: %s in the CSV, %s in ngspice\n", FNR, names[i], $i, theirs[FNR, i]; exit 1 } } }
    END { if (rows != FNR) { printf "%d rows in ngspice, %d in the CSV\n", rows, FNR; exit 1 } }' table FS=, run/result.csv

# the same peak as ngspice sees it in the samples; the summary also looks between them
peak=$(sed -nE 's/^peak += +([^ ]+) .*/\1/p' said)
jq -e --argjson peak "$peak" '.signals["left.voltage"].max | . >= $peak and . < $peak * 1.001' run/summary.json >tested

if command -v h5dump >tested; then
    for signal in x left.voltage energy.in; do
        column=$(head -n 1 run/result.csv | tr ',' '\n' | grep -n "^$signal \[" | cut -d: -f1)
        expect 0 h5dump -m %.11e -y -w 1 -d "/$signal" run/result.h5
        sed -nE '/DATA \{/,/\}/ s/^ *([-+0-9.e]+),?$/\1/p' out >theirs
        tail -n +2 run/result.csv | cut -d, -f"$column" >ours
        paste ours theirs | awk '{ gap = $1 - $2; size = $1 < 0 ? -$1 : $1
            if (NF != 2 || gap > 2e-11 * size || -gap > 2e-11 * size) { print NR ": " $0; exit 1 } }'
    done
fi
