# shellcheck shell=bash
# Every example's deck in plain ngspice gives our results: x and the voltages at the electrodes to 1e-3. Converters are cut
# short; tests/stress/decks.sh runs all of them to their end.
# shellcheck source=tests/cli/deck.sh
source "$ROOT/tests/cli/deck.sh"

# check EXAMPLE STEP OPTIONS ACCURACY [SET...]
check() {
    scene=$ROOT/examples/$1.yaml
    local step=$2 options=$3 accuracy=$4 pair
    shift 4
    expect 0 "$DEASIM" export "$scene" -o deck.cir "$@"
    expect 0 "$DEASIM" run "$scene" "$@" --accuracy "$accuracy" --set 'output.formats=[csv]' -o run -q
    tighten "$step" "$options"
    expect 0 ngspice -b -r deck.raw tight.cir
    for pair in $(pairs_of "$scene"); do
        within "$(compare "${pair%%=*}" "${pair#*=}")" 1e-3 "${pair%%=*}"
    done
}

half='transient.stop=100 ms'
check bidirectional 20u reltol=1e-5 1e-5 --set 'transient.stop=150 ms'
check bidirectional_half_bridge 20u reltol=1e-5 1e-5 --set 'transient.stop=90 ms'
check class_ab_amplifier 10u reltol=1e-5 1e-5
check h_bridge_reversal 20u reltol=1e-5 1e-5 --set 'transient.stop=120 ms'
check half_bridge_opto 20u reltol=1e-5 1e-5 --set "$half"
check leakage_hold 20u reltol=1e-5 1e-5 --set "$half"
check position_feedback 50u reltol=1e-5 1e-5
check rc_ladder 20u reltol=1e-5 1e-5
check rc_step 20u reltol=1e-5 1e-5
check rc_two_side_sine 20u reltol=1e-5 1e-5
check rlc 10u reltol=1e-5 1e-5
check self_sensing 5u reltol=1e-5 1e-5 --set "$half"
check two_devices 20u reltol=1e-5 1e-5 --set "$half"
check cockcroft_walton 1u reltol=1e-4 1e-4 --set 'transient.stop=3 ms'
check bidirectional_flyback 0.05u 'reltol=1e-4 trtol=1' 1e-4 --set 'transient.stop=0.3 ms'
check flyback_open 0.01u 'reltol=1e-5 trtol=1' 1e-4 --set 'transient.stop=0.35 ms'
check flyback_regulated 0.02u 'reltol=1e-4 trtol=1' 1e-4 --set 'transient.stop=0.35 ms'
