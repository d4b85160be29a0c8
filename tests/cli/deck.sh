# shellcheck shell=bash
# Sourced by what compares exported decks in plain ngspice with our own runs.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

scene='' # for messages

# read_vector RAW EXPRESSION: fills vector.txt with time and value.
read_vector() {
    printf 'title\n.control\nset wr_singlescale\nload %s\nwrdata vector.txt %s\n.endc\n.end\n' "$1" "$2" >load.cir
    rm -f vector.txt
    ngspice -b load.cir >/dev/null 2>&1 || true
    [ -s vector.txt ] || { echo "$1 holds no $2"; exit 1; }
}

# compare COLUMN EXPRESSION [RAW]: relative L2 difference of a column of run/result.csv and an expression of the deck's
# nodes, on the times of the former. Columns of displacement are in m, the deck's in mm.
compare() {
    local scale=1
    case $1 in x | *.x) scale=1e-3 ;; esac
    read_vector "${3:-deck.raw}" "$2"
    awk -F, -v column="$1" -v scale=$scale '
        NR == FNR { split($0, w, " "); t[++n] = w[1]; v[n] = w[2] * scale; next }
        FNR == 1 { for (i = 1; i <= NF; i++) if (index($i, column " [") == 1) c = i; next }
        { while (k + 1 < n && t[k + 1] < $1) k++
          if (k < 1) k = 1
          p = t[k + 1] > t[k] ? ($1 - t[k]) / (t[k + 1] - t[k]) : 0
          d = $c - (v[k] + p * (v[k + 1] - v[k])); e += d * d; s += $c * $c }
        END { printf "%.3e\n", (c && s > 0 ? sqrt(e / s) : -1) }' vector.txt run/result.csv
}

# within VALUE LIMIT WHAT
within() {
    awk -v v="$1" -v l="$2" 'BEGIN { exit !(v >= 0 && v <= l) }' && return 0
    printf '%s: %s differs by %s, allowed %s\n' "$scene" "$3" "$1" "$2"
    exit 1
}

# tighten STEP [OPTIONS]: deck.cir with this longest step and these options into tight.cir; without the measures, which cost.
tighten() {
    sed -E "s/^(\.tran [^ ]+ [^ ]+ 0) [^ ]+/\1 $1/; s/^\.end\$/.options ${2:-reltol=1e-5}\n.end/; /^\.meas/Id" deck.cir >tight.cir
}

# What to compare of each example; everything else has left and right.
pairs_of() {
    case $(basename "$1" .yaml) in
    h_bridge_reversal) echo 'x=v(pos) left.port_voltage=v(plus,minus)' ;;
    self_sensing) echo 'x=v(pos) left.port_voltage=v(left,sense)' ;;
    two_devices) echo 'DEA.x=v(pos_a) DEB.x=v(pos_b) DEA.left.port_voltage=v(left_a) DEB.left.port_voltage=v(left_b)' ;;
    bidirectional | bidirectional_half_bridge | class_ab_amplifier | rc_two_side_sine)
        echo 'x=v(pos) left.port_voltage=v(left) right.port_voltage=v(right)' ;;
    *) echo 'x=v(pos) left.port_voltage=v(left)' ;;
    esac
}
