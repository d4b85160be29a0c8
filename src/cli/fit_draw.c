/* The picture of `deasim fit`: data and fit. */
#include "cli/fit_print.h"

#include "deasim/gnuplot.h"
#include "deasim/new_file.h"
#include "deasim/result.h"

#include <math.h>
#include <stdio.h>

#define MAX_PATH 4096
#define CURVE_POINTS 400

static double answer_at(const struct fit_answer *answer, double x) {
    return answer->branches ? dea_step_answer(&answer->model, x) : dea_pull_stress(&answer->test, &answer->law, x);
}

static bool is_creep(const struct fit_answer *answer) {
    return answer->branches && answer->model.kind == DEA_STEP_CREEP;
}

/* Opens DIR/NAME for writing. */
static enum dea_status open_in(const char *directory, const char *name, char path[MAX_PATH], struct dea_new_file *made,
                               struct dea_error *error) {
    if (snprintf(path, MAX_PATH, "%s/%s", directory, name) >= MAX_PATH)
        return dea_fail(error, DEA_ERR_INPUT, "the folder name is too long");
    return dea_new_file_open(path, made, error);
}

static enum dea_status write_csv(const struct fit_answer *answer, const char *directory, struct dea_error *error) {
    char path[MAX_PATH];
    struct dea_new_file made;
    DEA_TRY(open_in(directory, "fit.csv", path, &made, error));
    const char *unit = is_creep(answer) ? "1" : "Pa", *word = is_creep(answer) ? "strain" : "stress";
    fprintf(made.file, "%s,%s [%s],fit [%s]\n", answer->branches ? "time [s]" : "stretch [1]", word, unit, unit);
    for (size_t i = 0; i < answer->data.count; i++)
        fprintf(made.file, "%.12g,%.12g,%.12g\n", answer->data.values[0][i], answer->data.values[1][i],
                answer_at(answer, answer->data.values[0][i]));
    return dea_new_file_finish(&made, DEA_OK, error);
}

static void write_script(const struct fit_answer *answer, FILE *file) {
    double factor = is_creep(answer) ? 1.0 : 1e-6, first = INFINITY, last = 0.0;
    for (size_t i = 0; i < answer->data.count; i++) {
        first = fmin(first, answer->data.values[0][i]);
        last = fmax(last, answer->data.values[0][i]);
    }
    fprintf(file,
            "set terminal pngcairo size 900,640 font 'sans,12'\nset termoption noenhanced\nset grid\nset autoscale "
            "noextend\n"
            "set offsets 0, 0, graph 0.04, graph 0.04\nset key %s\n"
            "set xlabel '%s'\nset ylabel '%s'\n%s$data << EOD\n",
            answer->branches && !is_creep(answer) ? "top right" : "top left",
            answer->branches ? "time after the step [s]" : "stretch", is_creep(answer) ? "strain" : "stress [MPa]",
            answer->branches ? "set logscale x\n" : "");
    for (size_t i = 0; i < answer->data.count; i++)
        fprintf(file, "%.9g %.9g\n", answer->data.values[0][i], answer->data.values[1][i] * factor);
    fprintf(file, "EOD\n$fit << EOD\n");
    for (int i = 0; i < CURVE_POINTS; i++) {
        double share = (double)i / (CURVE_POINTS - 1);
        double x = answer->branches ? first * pow(last / first, share) : first + share * (last - first);
        fprintf(file, "%.9g %.9g\n", x, answer_at(answer, x) * factor);
    }
    fprintf(file,
            "EOD\nplot $data with points pointtype 6 linecolor '#1f78b4' title 'data', \\\n"
            "     $fit with lines linewidth 2 linecolor '#d95f02' title '%s'\n",
            answer->branches ? "fit" : dea_law_name(answer->law.kind));
}

enum dea_status fit_draw(const struct fit_answer *answer, const char *directory, struct dea_error *error) {
    char script[MAX_PATH], picture[MAX_PATH + 8];
    struct dea_new_file made;
    DEA_TRY(dea_directory_make(directory, error));
    DEA_TRY(write_csv(answer, directory, error));
    DEA_TRY(open_in(directory, "fit.gnuplot", script, &made, error));
    write_script(answer, made.file);
    DEA_TRY(dea_new_file_finish(&made, DEA_OK, error));
    snprintf(picture, sizeof picture, "%s/fit.png", directory);
    return dea_gnuplot_draw_file(script, picture, error);
}
