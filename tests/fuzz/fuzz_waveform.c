/* Waveform files: what is read can be evaluated everywhere. */
#include "deasim/waveform.h"
#include "fuzz.h"

#include <math.h>

static void use(const struct dea_waveform *waveform) {
    double peak = dea_waveform_peak(waveform);
    fuzz_require(isfinite(peak) && peak >= 0.0, "the peak is finite");
    fuzz_require(waveform->point_count >= 2, "there are two points or more");
    for (size_t i = 0; i < waveform->point_count; i++) {
        double t = waveform->times[i], rate;
        fuzz_require(isfinite(t) && t >= 0.0 && (i == 0 || t >= waveform->times[i - 1]), "times do not go back");
        struct dea_piece piece;
        dea_waveform_piece(waveform, t, &piece);
        fuzz_require(piece.start <= t && piece.end > t, "a piece holds its time");
        fuzz_require(isfinite(dea_piece_value(&piece, t, &rate)) && isfinite(rate), "a value and its rate are finite");
        fuzz_require(fabs(dea_waveform_value(waveform, t)) <= peak * (1.0 + 1e-12), "no value is above the peak");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const name = "wave.csv";
    static const char *const units[] = {"V", "N"};
    fuzz_write_parts(data, size, &name, 1);
    for (int i = 0; i < 2; i++) {
        struct dea_waveform waveform;
        struct dea_error error = {0};
        if (fuzz_judge(dea_waveform_read_csv(name, units[i], &waveform, &error), &error))
            use(&waveform);
        dea_waveform_clear(&waveform);
    }
    return 0;
}
