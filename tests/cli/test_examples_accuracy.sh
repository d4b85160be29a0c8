# shellcheck shell=bash
# What accuracy promises, on the examples: books and coupling closed to A, and x and the electrodes' voltages at A within A of
# those at A/10. The flybacks take longer: ./dev validate.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

# run NAME A: into run-A
run() {
    expect 0 "$DEASIM" run "$ROOT/examples/$1.yaml" --accuracy "$2" --set 'output.formats=[csv]' -o "run-$2" -q
    jq -e --argjson a "$2" '.energy.imbalance <= $a and .coupling.error <= $a' "run-$2/summary.json" >/dev/null ||
        { echo "$1: books or coupling are not closed to $2:"; jq -c '.energy.imbalance, .coupling' "run-$2/summary.json"; exit 1; }
}

# differ COARSE FINE LIMIT: names the columns of x and port voltages whose relative L2 difference exceeds the limit.
differ() {
    paste -d, "$1" "$2" | awk -F, -v limit="$3" '
        NR == 1 { n = NF / 2; for (i = 1; i <= n; i++) if ($i ~ /(^|\.)(x|port_voltage) \[/) { name[i] = $i; found++ }; next }
        { for (i in name) { d = $i - $(i + n); e[i] += d * d; s[i] += $(i + n) * $(i + n) } }
        END { for (i in name) if (e[i] > limit * limit * s[i]) print name[i], sqrt(e[i] / (s[i] > 0 ? s[i] : 1))
              if (found < 2) print "no columns to compare" }'
}

for path in "$ROOT"/examples/*.yaml; do
    name=$(basename "$path" .yaml)
    case $name in *flyback*) continue ;; esac
    run "$name" 1e-3
    run "$name" 1e-4
    differ run-1e-3/result.csv run-1e-4/result.csv 1e-3 >differences
    [ ! -s differences ] || { echo "$name: the run at 1e-3 is further than that from the one at 1e-4:"; cat differences; exit 1; }
done
