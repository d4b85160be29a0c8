# deasim plot: draws what deasim run left, says what it cannot draw.
# shellcheck source=tests/cli/expect.sh
source "$ROOT/tests/cli/expect.sh"

expect 0 "$DEASIM" run "$ROOT/examples/bidirectional.yaml" --set transient.stop="20 ms" -o "a run" --quiet
expect 0 "$DEASIM" plot "a run"
[[ $(cat out) == "a run/result.png" ]]
[[ $(head -c 4 "a run/result.png" | od -An -c | tr -d ' ') == '211PNG' ]]
[[ $(ls "a run") != *part* ]]

# A result without its summary is drawn too; several folders, each on its own.
rm "a run/summary.json"
expect 2 "$DEASIM" plot nothing "a run"
has out "a run/result.png"
has err "deasim plot: nothing/result.csv: there is no result to draw: No such file or directory"

# numbers of a summary that are none are not drawn
printf '{"title": "t", "limits": {"x": 1e999}, "events": [{"t": 1e999, "type": "stop"}, 5, null]}\n' >"a run/summary.json"
expect 0 "$DEASIM" plot "a run"

expect 0 "$DEASIM" plot --help
has out "usage: deasim plot DIR"
expect 2 "$DEASIM" plot
has err "deasim plot: name a result folder"
expect 2 "$DEASIM" plot ""
has err "deasim plot: a result folder needs a name; . is this one"
expect 2 "$DEASIM" plot --colour
has err "deasim plot --help"

mkdir empty
expect 3 env PATH="$PWD/empty" "$DEASIM" plot "a run"
has err "gnuplot is not installed (or not on PATH); on Debian: apt install gnuplot-nox"
