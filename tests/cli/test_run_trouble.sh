# shellcheck shell=bash
# deasim run when things go wrong on the way: interrupts, folders that cannot be written, full disks. What was computed is
# kept, readable, and the exit code and the summary say what happened.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

cat >long.yaml <<END
title: Rings for ever
device: $ROOT/models/planar_c_elastic.yaml
drive:
  left: {waveform: {type: sine, amplitude: 1 kV, frequency: 1 kHz}}
transient: {stop: 1000 s}
output: {sample: 1 ms, formats: [csv, raw, hdf5]}
END

# whole_rows FILE: every row of a CSV has as many cells as its header, and the last one ends with its line.
whole_rows() {
    awk -F, 'NR == 1 { cells = NF } NF != cells { print FILENAME ": row " NR " has " NF " cells"; exit 1 }' "$1"
    [[ $(tail -c 1 "$1" | od -An -c | tr -d ' ') == '\n' ]] || { echo "$1 ends within a row"; exit 1; }
}

# raw_points FILE: the number of points its header promises, which its data must hold.
raw_points() {
    local points variables header
    points=$(grep -a -m 1 '^No. Points:' "$1" | tr -dc 0-9)
    variables=$(grep -a -m 1 '^No. Variables:' "$1" | tr -dc 0-9)
    header=$(grep -a -b -m 1 '^Binary:' "$1" | cut -d: -f1)
    (($(stat -c %s "$1") >= header + 8 + points * variables * 8)) || { echo "$1 holds less than $points points"; exit 1; }
    echo "$points"
}

# ---- interrupts ----
for signal in INT TERM HUP; do
    "$DEASIM" run long.yaml -o "stopped-$signal" --json >out 2>err &
    pid=$!
    for ((i = 0; i < 200; i++)); do # until rows are on the disk
        [[ -s stopped-$signal/result.csv ]] && (($(wc -l <"stopped-$signal/result.csv") > 100)) && break
        sleep 0.05
    done
    kill -s "$signal" $pid
    code=0
    wait $pid || code=$?
    ((code == 3)) || { echo "exit code $code after SIG$signal"; cat err; exit 1; }
    has err "s: interrupted by SIG$signal"
    jq -e --arg s "SIG$signal" '.status == "failed" and (.reason | endswith("interrupted by " + $s)) and .t_end > 0.01' out >tested
    cmp <(jq -S . out) <(jq -S . "stopped-$signal/summary.json")
    has "stopped-$signal/log.txt" "interrupted by SIG$signal"
    whole_rows "stopped-$signal/result.csv"
    rows=$(($(wc -l <"stopped-$signal/result.csv") - 1))
    points=$(raw_points "stopped-$signal/result.raw")
    ((rows == points)) || { echo "$rows rows in the CSV, $points points in the raw file"; exit 1; }
    if command -v h5dump >tested; then
        expect 0 h5dump -d /time -H "stopped-$signal/result.h5"
        has out "( $rows )"
    fi
    expect 0 "$DEASIM" plot "stopped-$signal"
    read -r width height < <(od -An -j16 -N8 --endian=big -tu4 "stopped-$signal/result.png") # of the PNG's header
    ((width >= 800 && height >= 800)) || { echo "a picture of $width x $height"; exit 1; }
done

# a run that is mostly rows can be stopped as well
sed 's/stop: 1000 s/stop: 1 s/; s/sample: 1 ms/sample: 10 ns/; s/, raw, hdf5//; s/type: sine.*kHz/type: dc, level: 0 V/' long.yaml >rows.yaml
code=0
timeout --signal=INT 2 "$DEASIM" run rows.yaml -o rows --quiet 2>err || code=$?
((code == 124)) && has err "interrupted by SIGINT"
((code == 124)) || { echo "exit code $code"; cat err; exit 1; }
whole_rows rows/result.csv
rm -r rows

# ---- folders that cannot be written ----
: >file
expect 2 "$DEASIM" run long.yaml -o file
has err "file: "
expect 2 "$DEASIM" run long.yaml -o file/below
has err "file/below"
expect 2 "$DEASIM" run long.yaml -o /proc/nowhere
has err "/proc/nowhere"
[[ ! -s out ]]
mkdir -p busy/result.csv
expect 2 "$DEASIM" run long.yaml -o busy
has err "busy/result.csv"
if ((EUID == 0)); then
    mkdir closed && chmod 755 . closed && chmod 500 closed
    if command -v setpriv >tested && setpriv --reuid=65534 --clear-groups test -x "$DEASIM" -a -r long.yaml; then
        expect 2 setpriv --reuid=65534 --clear-groups "$DEASIM" run long.yaml -o closed/run
        has err "closed/run"
        has err "Permission denied"
    fi
fi

# ---- a full disk: first a limit on file sizes, then, where this may be tried, a small file system ----
disk_full() { # FOLDER WORDS: the run has failed with 3, names the files and their good rows, which are there
    has err "result.csv is incomplete: $2; its first "
    whole_rows "$1/result.csv"
    local good
    good=$(sed -nE 's|.*result\.csv is incomplete: [A-Za-z ]+; its first ([0-9]+) rows are good.*|\1|p' err | head -n 1)
    ((good > 10 && good == $(wc -l <"$1/result.csv") - 1)) || { echo "$good rows promised"; wc -l "$1/result.csv"; exit 1; }
    jq -e '.status == "failed" and (.reason | test("result.csv is incomplete")) and .signals.x.max > 0' out >tested
}
sed 's/stop: 1000 s/stop: 2 s/; s/, raw, hdf5//' long.yaml >csv.yaml
expect 3 bash -c "ulimit -f 100; '$DEASIM' run csv.yaml -o limited --json"
disk_full limited "File too large"
# the same with a netlist, whose rows come from a process of their own
printf 't\nVs s 0 SIN(0 1000 10)\nRs s a 1Meg\nDx a left d\n.model d D\nRl left 0 100Meg\nXdea left 0 right 0 pos DEA\nRr right 0 1k\n' >many.cir
printf 'device: %s\ndrive: {netlist: many.cir}\ntransient: {stop: 0.5 s}\noutput: {sample: 0.1 ms, formats: [csv]}\n' \
    "$ROOT/models/planar_c_s5.yaml" >many.yaml
expect 3 bash -c "ulimit -f 100; '$DEASIM' run many.yaml -o limited --json"
disk_full limited "File too large"
jq -e '.status == "failed"' limited/summary.json >tested
mkdir small
if ((EUID == 0)) && mount -t tmpfs -o size=200k tmpfs small 2>mounted; then
    code=0
    "$DEASIM" run csv.yaml -o small/run --json >out 2>err || code=$?
    if ((code == 3)); then
        (disk_full small/run "No space left on device") || code=1
    fi
    sed 's/csv/csv, raw, hdf5/' csv.yaml >all.yaml
    rm -r small/run
    (expect 3 "$DEASIM" run all.yaml -o small/run --json && has err "result.h5 is incomplete: No space left on device" &&
        raw_points small/run/result.raw >points) || code=1
    umount small
    ((code == 3)) || { echo "exit code $code"; cat err; exit 1; }
fi
