# shellcheck shell=bash
# deasim run, check and test: what is printed and written, options, exit codes.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

cat >scene.yaml <<END
title: A step
device: $ROOT/models/planar_c_s5.yaml
drive:
  left: {waveform: {type: pulse, high: 2 kV, delay: 1 ms, rise: 100 us}, resistance: 1 MOhm}
transient: {stop: 20 ms}
output: {sample: 0.1 ms, formats: [csv, raw, hdf5]}
expect:
  - {signal: x, measure: max, above: 0.1 mm, below: 0.3 mm}
END

# ---- files and summary ----
expect 0 "$DEASIM" run scene.yaml -o deep/er/out
has out "A step: done at 20 ms (native,"
has out "left.true_field"
has out "imbalance"
[[ $(ls deep/er/out) == $'log.txt\nresult.csv\nresult.h5\nresult.raw\nsummary.json' ]] || { ls deep/er/out; exit 1; }
cd deep/er/out
(($(wc -l <result.csv) == 202)) || { wc -l result.csv; exit 1; }
has result.csv "time [s],x [m],v [m/s],left.stretch [1],left.tension [N],left.stress2 [Pa],left.voltage [V],"
head -c 14 result.raw >head && has head "Title: A step"
[[ $(head -c 4 result.h5 | tail -c 3) == HDF ]]
has log.txt "states: x v | left: xi1[1] xi2[1] xi1[2] xi2[2] Q | right: xi1[1] xi2[1] xi1[2] xi2[2]"
awk -F, 'NR > 1 { if (NF != 25) { print "row " NR ": " NF " cells"; exit 1 }
    for (i = 1; i <= NF; i++) if ($i !~ /^-?[0-9.]+(e[-+]?[0-9]+)?$/) { print "row " NR ": " $i; exit 1 } }' result.csv
cd ../../..

# ---- the JSON object of the contract, on the terminal and in the folder ----
expect 0 "$DEASIM" run scene.yaml --json -o json
jq -e >tested '[.scene, .status, .t_end] == ["scene.yaml", "done", 0.02]' out
jq -e >tested '.signals.x | .min <= .final and .final < .max and .t_max > 0.003 and .t_max < 0.006' out
for signal in x v left.{voltage,port_voltage,charge,current,capacitance,true_field,stretch,tension,stress2} right.voltage; do
    jq -e >tested --arg s $signal '.signals[$s] | (has("min") and has("max") and has("final") and has("t_max"))' out
done
jq -e >tested '.measures == {} and .coupling.error == 0 and .coupling.redone == 0' out
jq -e >tested '.energy | .in > 0 and .dissipated > 0 and .imbalance < 1e-3 and ((.in - .stored - .dissipated) / .in | fabs) < 1e-3' out
jq -e >tested '.stats | .circuit_points == 0 and .circuit_rejected == 0 and .plant_steps > 50 and .residuals >= .plant_steps
    and .jacobians > 0 and .wall_s > 0 and .mode == "native"' out
jq -e >tested '.events == []' out
jq 'del(.stats.wall_s)' out >printed
jq 'del(.stats.wall_s)' json/summary.json >written
cmp printed written
[[ ! -s err ]] || { cat err; exit 1; }

# events, stopping at one
expect 0 "$DEASIM" run scene.yaml --json --set drive.left.waveform.high="3.6 kV" --set events.breakdown=stop
jq -e >tested '.status == "stopped" and .t_end < 0.01 and (.reason | test("breakdown in zone left"))' out
jq -e >tested '.events[0] | .type == "breakdown" and .zone == "left" and .t > 0.001' out
has err "warning: t = 0.00"

# a motion that multiplies errors says so, one that swings does not
jq -e >tested '.sensitivity > 0.5 and .sensitivity < 2' json/summary.json
expect 0 "$DEASIM" run "$ROOT/tests/cases/end_stops_lossy.yaml" --json
has err "warning: the motion multiplies small errors "
has err "compare with a run at --accuracy 1e-05"
jq -e >tested '.sensitivity >= 4' out

# ---- how much is said ----
expect 0 "$DEASIM" run scene.yaml --quiet --set drive.left.waveform.high="3.6 kV"
[[ ! -s out && ! -s err ]] || { cat out err; exit 1; }
expect 0 "$DEASIM" run scene.yaml --verbose
has err "states: x v | left: xi1[1] xi2[1] xi1[2] xi2[2] Q | right: xi1[1] xi2[1] xi1[2] xi2[2]"
expect 0 "$DEASIM" run scene.yaml --verbose --set device.material.branches=null --set drive.left.resistance=0 \
    --set device.platform.mass=0 --set device.options.membrane_mass=false
has err "states: x | left: | right:"
has out "(static,"
expect 0 "$DEASIM" run scene.yaml -v --set drive.left.amplifier="{bandwidth: 1 kHz}"
has err "xi2[2] u Q |"

# ---- overrides and accuracy ----
expect 0 "$DEASIM" run scene.yaml --json --set transient.stop="5 ms" --set output.formats="[csv]" -o out5
jq -e >tested '.t_end == 0.005' out
[[ $(ls out5) == $'log.txt\nresult.csv\nsummary.json' ]] || { ls out5; exit 1; }
# an earlier run's files do not stay behind
expect 0 "$DEASIM" run scene.yaml --quiet --set output.formats="[raw]" --set output.signals="[x]" -o out5
[[ $(ls out5) == $'log.txt\nresult.raw\nsummary.json' ]] || { ls out5; exit 1; }
steps() { jq '.stats.plant_steps' out; }
expect 0 "$DEASIM" run scene.yaml --json --accuracy 1e-2
rough=$(steps)
expect 0 "$DEASIM" run scene.yaml --json --accuracy 1e-7
((rough * 2 < $(steps))) || { echo "$rough steps at 1e-2, $(steps) at 1e-7"; exit 1; }
expect 2 "$DEASIM" run scene.yaml --accuracy 0
has err "--accuracy 0: a number from 1e-12 to 0.1 is allowed"
expect 2 "$DEASIM" run scene.yaml --accuracy 1e-13
expect 2 "$DEASIM" run scene.yaml --accuracy fine
expect 2 "$DEASIM" run scene.yaml --set nonsense
has err "--set nonsense: write key=value"
expect 2 "$DEASIM" run scene.yaml --set transient.stpo=1
has err "--set transient.stpo=1: transient: unknown key 'stpo'; did you mean 'stop'?"
expect 2 "$DEASIM" run scene.yaml other.yaml
has err 'one scene at a time (deasim test runs several); what is "other.yaml"?'
expect 2 "$DEASIM" run
has err "name a scene file"
expect 2 "$DEASIM" run scene.yaml --bogus
has err "deasim run: unknown option --bogus, see deasim run --help"
expect 2 "$DEASIM" run scene.yaml -z
has err "deasim run: unknown option -z, see deasim run --help"
expect 2 "$DEASIM" run scene.yaml --json=1
has err "deasim run: --json takes no value, see deasim run --help"
expect 2 "$DEASIM" run scene.yaml -o
has err "deasim run: a value is missing after -o, see deasim run --help"

# ---- the sample time changes the files and nothing else: equal values at common times, equal steps ----
expect 0 "$DEASIM" run scene.yaml --json --set output.formats="[csv]" -o coarse --set output.sample="0.4 ms"
coarse=$(jq -c '[.stats.plant_steps, .stats.residuals, .stats.jacobians, .energy]' out)
expect 0 "$DEASIM" run scene.yaml --json --set output.formats="[csv]" -o fine --set output.sample="0.1 ms"
fine=$(jq -c '[.stats.plant_steps, .stats.residuals, .stats.jacobians, .energy]' out)
[[ $coarse == "$fine" ]] || { echo "$coarse"; echo "$fine"; exit 1; }
awk 'NR == 1 || (NR - 2) % 4 == 0' fine/result.csv >common
cmp common coarse/result.csv

# ---- check and test ----
expect 0 "$DEASIM" check scene.yaml
has out "scene.yaml: device DEA, stiffness 554.1 N/m, rest capacitance 80.49 pF"
has out "scene.yaml: good"
expect 0 "$DEASIM" check --quiet scene.yaml
[[ ! -s out ]]
expect 0 "$DEASIM" test scene.yaml
has out "ok     scene.yaml"
has out "1 passed, 0 failed"
sed 's/below: 0.3 mm/below: 0.11 mm/' scene.yaml >unmet.yaml
expect 1 "$DEASIM" test --quiet scene.yaml unmet.yaml
lacks out "ok "
has out "FAILED unmet.yaml"
# an option that a command would not heed is a mistake
expect 2 "$DEASIM" check scene.yaml --json
has err "deasim check: unknown option --json, see deasim check --help"
expect 2 "$DEASIM" test scene.yaml -o out
has err "deasim test: unknown option -o, see deasim test --help"
expect 2 "$DEASIM" export scene.yaml --accuracy 1e-3
has err "deasim export: unknown option --accuracy, see deasim export --help"
expect 2 "$DEASIM" export scene.yaml other.yaml
has err 'deasim export: one scene at a time (deasim test runs several); what is "other.yaml"?'
expect 1 "$DEASIM" test scene.yaml unmet.yaml
has out "unmet.yaml:8: x max = 0.000"
has out "expected above 0.0001 and below 0.00011: not met"
has out "FAILED unmet.yaml"
has out "1 passed, 1 failed"
expect 0 "$DEASIM" run unmet.yaml # expectations are judged by test alone
expect 2 "$DEASIM" test scene.yaml missing.yaml
has err "missing.yaml"
has out "1 passed, 1 failed"
sed 's/high: 2 kV/high: 100 kV/' scene.yaml >wild.yaml
expect 3 "$DEASIM" test wild.yaml
has out "FAILED wild.yaml"
expect 3 "$DEASIM" run wild.yaml --json -o wild
has err "the platform ran into the frame"
has err "last steps:"
has wild/log.txt "the platform ran into the frame"
jq -e >tested '.status == "failed" and (.reason | test("ran into the frame")) and .signals.x.max > 1e-3' wild/summary.json
cmp <(jq .reason out) <(jq .reason wild/summary.json)
(($(wc -l <wild/result.csv) > 20))

# ---- a bar for people only ----
long=(--set "drive.left={waveform: {type: sine, amplitude: 1 kV, frequency: 1 kHz}}" --set "transient.stop=10 s" --set "output.sample=0.1 s")
expect 0 script -qec "'$DEASIM' run scene.yaml ${long[*]@Q}" /dev/null
has out "%  "
has out " of 10 s, "
lacks out "nan"
expect 0 "$DEASIM" run scene.yaml "${long[@]}"
[[ ! -s err ]] || { cat err; exit 1; }
lacks out "%"
expect 0 script -qec "'$DEASIM' run scene.yaml --quiet ${long[*]@Q}" /dev/null
[[ ! -s out ]] || { cat -A out; exit 1; }

# ---- the rest of the program ----
expect 2 "$DEASIM"
has err "usage: deasim COMMAND"
expect 0 "$DEASIM" --help
has out "exit codes: 0 good, 1 an expectation failed, 2 bad input, 3 the solver gave up"
expect 0 "$DEASIM" --version
has out "deasim 0."
expect 2 "$DEASIM" rum
has err 'unknown command "rum"'
for command in run check test static map optimum fit plot export; do
    expect 0 "$DEASIM" $command --help
    has out "usage: deasim $command"
    mv out help
    expect 0 "$DEASIM" $command -h
    cmp help out
done

# a full terminal is not success
expect 3 bash -c "'$DEASIM' run scene.yaml >/dev/full"
has err "deasim run: the answer could not be written: No space left on device"
expect 3 bash -c "'$DEASIM' run scene.yaml --json >/dev/full"
