# shellcheck shell=bash
# Netlists that are broken, cannot be solved or mean harm: each ends in time with its exit code and a message that names
# the place, none crashes, and nothing in them is executed.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

cat >scene.yaml <<END
title: Bad netlists
device: $ROOT/models/planar_c_s5.yaml
drive: {netlist: bad.cir}
transient: {stop: 5 ms}
output: {formats: [csv, raw, hdf5]}
END
head=$'title\nVs s 0 PULSE(0 3000 1m 10u 10u 1 2)\nRs s left 1Meg\nRr right 0 1Meg\nXdea left 0 right 0 pos DEA'

tried=0
# ends CODE MESSAGE [ARGUMENT...]: running bad.cir ends with the code within a minute, the message on stderr, nothing on
# stdout; nothing was executed. What was written stays in the folder `run`.
ends() {
    local code=$1 message=$2
    shift 2
    rm -rf run
    expect "$code" timeout --kill-after=5 60 "$DEASIM" run scene.yaml -o run -q "$@"
    has err "$message"
    lacks err "crash"
    lacks err "killed"
    lacks err "internal"
    [[ ! -s out ]] || { cat out; exit 1; }
    ((code == 3)) || [[ ! -e run/result.csv && ! -e run/summary.json ]] || { echo "results of a refused netlist"; exit 1; }
    [[ -z $(find . -name 'canary*') ]] || { echo "a command was executed"; cat bad.cir; exit 1; }
    tried=$((tried + 1))
}

# bad CODE MESSAGE LINE...: the head and these lines, with the engine of its own choice and with ngspice.
bad() {
    local code=$1 message=$2
    shift 2
    printf '%s\n' "$head" "$@" >bad.cir
    ends "$code" "$message"
    ends "$code" "$message" --engine ngspice
}

# whole CODE MESSAGE LINE...: only these lines behind the title.
whole() {
    local code=$1 message=$2
    shift 2
    printf '%s\n' title "$@" >bad.cir
    ends "$code" "$message"
}

printf '%s\n' "$head" >bad.cir
expect 0 "$DEASIM" run scene.yaml -o good -q # the head alone is fine

# ---- syntax ----
bad 2 "bad.cir:6: ngspice refuses the circuit: PTerror: syntax error" "B1 q 0 V=V(left)*/2"
bad 2 "bad.cir:7: '(' is not closed" "R1 left 0 1k" "V1 q 0 PULSE(0 1"
bad 2 "bad.cir:6: a quote (') is not closed" "R1 left 0 '1k"
bad 2 "bad.cir:6: ngspice refuses the circuit: r1 left 0 1k bla=3; unknown parameter (bla)" "R1 left 0 1k bla=3"
bad 2 "bad.cir:6: ngspice refuses the circuit: Undefined parameter [foo]" "R1 left 0 {foo*2}"
bad 2 "bad.cir:6: .foo is not allowed" ".foo 1 2"
bad 2 'bad.cir:6: not an element: "?R1 left 0 1k"' "?R1 left 0 1k"
bad 2 "bad.cir:7: ngspice refuses the circuit: r1 left 0 2k; device already exists" "R1 left 0 1k" "R1 left 0 2k"

# ---- no mistakes, but told: once, on the terminal and in the log ----
printf '%s\n' "$head" "R9 left 0 100M" "R8 left 0 100Meg" "C9 q 0 1F" "R7 q 0 1k" ".ac dec 10 1 1k" >bad.cir
for engine in auto ngspice; do
    expect 0 "$DEASIM" run scene.yaml -o run --engine $engine --set events.breakdown=ignore
    for file in err run/log.txt; do
        has $file "warning: bad.cir:6: 100M is 100 milliohm: M is milli in SPICE, Meg is a million"
        has $file "warning: bad.cir:8: 1F is 1 femtofarad: F behind a number is femto in SPICE"
        has $file "warning: bad.cir:10: .ac left out: only the transient is run"
        (($(grep -c "bad.cir:" $file) == 3)) || { cat $file; exit 1; }
    done
done
expect 0 "$DEASIM" check scene.yaml
has err "warning: bad.cir:10: .ac left out: only the transient is run"
expect 0 "$DEASIM" check --quiet scene.yaml
[[ ! -s err ]]

# a .measure that fails: which and why in one line
printf '%s\n' "$head" ".measure tran rise trig v(left) val=100 rise=1 targ v(left) val=9k rise=1" ".measure tran lost max v(nope)" \
    ".measure tran twice param='rise*2'" >bad.cir
expect 0 "$DEASIM" run scene.yaml --engine ngspice
has err "warning: .measure tran rise trig v(left) val=100 rise=1 targ v(left) val=9k rise=1 failed: out of interval"
has err "warning: .measure tran lost max v(nope) failed: no such vector as 'v(nope)'"
has err "warning: Undefined parameter [rise]" # no line of its own tells which
lacks err "Netlist line no."
(($(grep -c "out of interval" err) == 1)) || { cat err; exit 1; }

# ---- missing things ----
bad 2 "bad.cir:6: ngspice refuses the circuit: warning, can't find model 'nomodel'" "D1 left 0 nomodel"
bad 2 "bad.cir:6: ngspice refuses the circuit: Error: unknown subckt: x2 left 0 nosub" "X2 left 0 nosub"
bad 2 "bad.cir:6: cannot open nowhere.inc: No such file or directory" ".include nowhere.inc"
bad 2 "bad.cir:6: cannot open nowhere.lib: No such file or directory" ".lib nowhere.lib typical"
bad 2 "bad.cir:7: ngspice refuses the circuit: Fatal error: k1: coupling to non-existant inductor l2" \
    "L1 left 0 1m" "K1 L1 L2 0.9"

# ---- pins ----
bad 2 "bad.cir:6: r1: nodes or a value are missing; written as in R1 p n 1k" "R1 left 1k"
bad 2 "bad.cir:6: v1: nodes or a value are missing" "V1 left"
bad 2 "bad.cir:6: k1: nodes or a value are missing" "K1 L1 0.9"
bad 2 "bad.cir:9: ngspice refuses the circuit: Too few parameters for subcircuit type" \
    ".subckt two a b" "R1 a b 1k" ".ends" "X1 left two"
whole 2 "bad.cir:3: xdea: device DEA has 5 pins (left p, left n, right p, right n, pos), 3 nodes are given" \
    "V1 left 0 1" "Xdea left 0 pos DEA"
whole 2 "bad.cir: device DEA is never used; call it as Xname nodes DEA" "V1 left 0 1" "R1 left 0 1k"

# ---- no operating point ----
whole 3 "bad.cir:2: no operating point at t = 0, singular at left: a node without DC path to ground" \
    "I1 0 left 1u" "Rr right 0 1Meg" "Xdea left 0 right 0 pos DEA"
bad 3 "bad.cir:6: no operating point at t = 0, singular at a: a node without DC path to ground" \
    "Ca a 0 1n" "Ia 0 a 1u"
bad 3 "bad.cir:6: no operating point at t = 0, singular at v1#branch: voltage sources or inductors in a loop" \
    "V1 a 0 1" "V2 a 0 2"
bad 3 'bad.cir:6: no operating point at t = 0, trouble with node "b"' "B1 b 0 V=V(b)>0.5 ? 0 : 1" "R2 b 0 1k"
bad 3 'bad.cir:11: no operating point at t = 0, trouble with node "xs.b"' \
    ".subckt sub a" "B1 b 0 V=V(b)>0.5 ? 0 : 1" "R2 b 0 1k" "R3 a 0 1k" ".ends" "Xs left sub"

# ---- no solution at a switching edge: none for V(b) once the left electrode is above 1 kV; what was computed is kept ----
bad 3 'bad.cir:6: the circuit gave up at t = 0.00103' "B1 b 0 V=V(left)>1000 ? (V(b)>0.5 ? 0 : 1) : 0" "R2 b 0 1k"
has err 'trouble with node "b"'
has err "last steps (t, dt): "
has err " rejected by ngspice"
has err " accepted; "
expect 3 "$DEASIM" run scene.yaml -o run --json
jq -e '.status == "failed" and (.reason | test("gave up at t = 0.00103")) and .t_end > 1.03e-3 and .t_end < 1.04e-3
    and .signals["left.voltage"].max > 900' out >tested
has run/log.txt "last steps (t, dt): "
# told once, not at every repetition with looser tolerances
expect 3 "$DEASIM" run scene.yaml
(($(grep -c "repeating the run" err) > 1 && $(grep -o "last steps" err | wc -l) == 1)) || { cat err; exit 1; }
rows=$(($(wc -l <run/result.csv) - 1))
((rows > 100)) || { echo "only $rows rows are kept"; exit 1; }
awk -F, 'NR > 1 { t = $1 } END { exit !(t > 1.03e-3 && t < 1.04e-3) }' run/result.csv
for file in run/result.raw run/result.h5 run/summary.json; do
    [[ -s $file ]] || { echo "$file is not there"; exit 1; }
done

# ---- commands ----
bad 2 "bad.cir:6: .control blocks are refused" .control "shell touch canary" .endc
bad 2 "bad.cir:6: .control blocks are refused" ".CONTROL" "echo x > canary" ".ENDC"
bad 2 "bad.cir:6: lines beginning with *# are refused" "*# shell touch canary"
bad 2 "bad.cir:6: .exec is not allowed" ".exec touch canary"
# shellcheck disable=SC2016 # meant literally
bad 2 "bad.cir:6: not an element" '`touch canary`'
bad 2 "bad.cir:6: models of type d_process are refused" '.model p d_process(process_file="touch" process_params=["canary"])'
printf '%s\n' ".control" "shell touch canary" ".endc" >evil.inc
bad 2 "evil.inc:1: .control blocks are refused" ".include evil.inc"
bad 2 "/etc/passwd is outside the netlist's folder" ".include /etc/passwd"
echo 'shell touch canary' >.spiceinit
printf '%s\n' "$head" >bad.cir
expect 0 "$DEASIM" run scene.yaml -o run -q --engine ngspice
[[ ! -e canary ]] || { echo "the .spiceinit of the working folder was executed"; exit 1; }
rm .spiceinit

# ---- what crashes ngspice or never ends ----
bad 2 "bad.cir:6: n of a URC line must be a plain number from 1 to 200, not \"100k\"" "U1 left q 0 m l=1 n=100k" \
    ".model m urc(rperl=1k cperl=1p)"
printf '%s\n' "$head" "U1 left q 0 m l=1 n=200" ".model m urc(rperl=1k cperl=1p)" "R1 q 0 1meg" >bad.cir
expect 0 "$DEASIM" run scene.yaml -o run -q
bad 2 "bad.cir:6: max() takes 2 arguments, 3 are given" "B1 q 0 V=max(V(left),1,2)" "R1 q 0 1k"
bad 2 "bad.cir:6: .func f calls itself" ".func f(x) {f(x)+1}" "R1 left 0 {f(1)}"
bad 2 "bad.cir:7: subcircuits nested more than 20 deep (does a call itself?)" ".subckt a n" "X1 n a" ".ends" "X1 left a"
bad 2 "bad.cir:6: r1: no node may be named temper" "R1 temper 0 1k"
bad 2 "bad.cir:6: .measure v: find needs at=.. or when .." ".measure tran v find v(left)"
bad 2 "bad.cir:6: PWL: the time 1u goes back" "V1 q 0 PWL(0 0 2u 1 1u 0)"

# ---- files ----
echo '.include self.inc' >self.inc
bad 2 "self.inc:1: endless .include: self.inc <- self.inc <- bad.cir" ".include self.inc"
echo '.include pong.inc' >ping.inc
echo '.include ping.inc' >pong.inc
bad 2 "pong.inc:1: endless .include: ping.inc <- pong.inc <- ping.inc <- bad.cir" ".include ping.inc"
(yes 'R1 left 0 1k' || true) | head -c 100000000 >bad.cir
ends 2 "bad.cir: a netlist with its includes may have at most 16 MB, this file has 100000000 bytes"
head -c 15000000 bad.cir >part && mv part bad.cir
ends 2 "bad.cir:100001: a netlist may have at most 100000 lines"
{ echo title; head -c 10000000 /dev/zero | tr '\0' '('; } >bad.cir
ends 2 "bad.cir:2: not an element"
{ echo title; printf 'B1 a 0 V='; head -c 1000000 /dev/zero | tr '\0' '('; } >bad.cir
ends 2 "bad.cir:2: brackets nested more than 64 deep"
cp "$DEASIM" bad.cir
ends 2 "bad.cir:1: not a text file (byte 0x02)"
gzip -c "$ROOT/README.md" >bad.cir
ends 2 "bad.cir:1: not a text file (byte 0x"
: >bad.cir
ends 2 "bad.cir: "
rm bad.cir && mkdir bad.cir
ends 2 "scene.yaml:3:18: drive.netlist: cannot read bad.cir: it is a directory"
rmdir bad.cir && mkfifo bad.cir
ends 2 "scene.yaml:3:18: drive.netlist: cannot read bad.cir: it is not a regular file"
rm bad.cir && ln -s bad.cir bad.cir
ends 2 "scene.yaml:3:18: drive.netlist: cannot read bad.cir: Too many levels of symbolic links"

echo "$tried bad netlists"
