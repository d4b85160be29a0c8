/* Tables of what was measured. */
#include "accuracy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DISAGREEMENT 1e-7 /* between the independent program and the program's own reference */
#define STILL 1e-13       /* an error below says that nothing moves, or nothing but rounding */

double point_error(const struct point *point) {
    return fmax(point->delivered.x, point->delivered.ports);
}

bool point_counts(const struct point *point) {
    return point->problem[0] == '\0' && !point->sensitive && !point->unsure && point_error(point) > STILL;
}

void write_csv(const struct points *points, FILE *file) {
    fprintf(file,
            "scene,mode,asked,delivered,x,ports,imbalance,reference,reference accuracy,doubt,steps,seconds,judged,"
            "problem\n");
    for (size_t i = 0; i < points->count; i++) {
        const struct point *p = &points->points[i];
        fprintf(file, "%s,%s,%g,%.4g,%.4g,%.4g,%.4g,%s,%g,%.2g,%.0f,%.3f,%d,%s\n", p->scene, p->mode, p->asked,
                point_error(p), p->delivered.x, p->delivered.ports, p->imbalance, p->reference, p->reference_at,
                p->doubt, p->steps, p->seconds, point_counts(p), p->problem);
    }
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Points of a mode ("" for all) and accuracy (0 for all) as one line of the table. */
static void write_line(const struct points *points, const char *mode, double asked, FILE *file) {
    double *ratios = malloc((points->count + 1) * sizeof *ratios);
    size_t count = 0, failed = 0, exceeded = 0, unbalanced = 0;
    if (ratios == NULL)
        return;
    for (size_t i = 0; i < points->count; i++) {
        const struct point *p = &points->points[i];
        if ((mode[0] != '\0' && strcmp(mode, p->mode) != 0) || (asked > 0.0 && fabs(p->asked / asked - 1.0) > 0.1))
            continue;
        failed += p->problem[0] != '\0';
        unbalanced += p->imbalance > p->asked;
        if (!point_counts(p))
            continue;
        ratios[count++] = p->asked / point_error(p);
        exceeded += point_error(p) > p->asked;
    }
    qsort(ratios, count, sizeof *ratios, compare);
    char column[16] = "all";
    if (asked > 0.0)
        snprintf(column, sizeof column, "%.0e", asked);
    if (count > 0)
        fprintf(file, "| %s | %s | %zu | %.3g | %.3g | %.3g | %zu | %zu | %zu |\n", mode[0] != '\0' ? mode : "all",
                column, count, ratios[count / 2], ratios[0], ratios[count - 1], exceeded, unbalanced, failed);
    free(ratios);
}

int write_table(const struct points *points, FILE *file) {
    static const char *const modes[] = {"static", "native", "linear", "cosim", ""};
    int exceeded = 0;
    fprintf(file,
            "| mode | asked | runs | asked/delivered: median | least | most | exceeded | books worse than asked | "
            "failed |\n|---|---|---|---|---|---|---|---|---|\n");
    for (size_t m = 0; m < sizeof modes / sizeof modes[0]; m++) {
        for (int decade = FIRST_DECADE; decade <= LAST_DECADE; decade++)
            write_line(points, modes[m], pow(10.0, -decade), file);
        write_line(points, modes[m], 0.0, file);
    }
    fprintf(file, "\n");
    for (size_t i = 0; i < points->count; i++) {
        const struct point *p = &points->points[i];
        if (p->reference_at <= 0.0 && p->doubt > DISAGREEMENT && (i == 0 || strcmp(p->scene, p[-1].scene) != 0))
            fprintf(file, "- %s: the independent program differs by %.1e\n", p->scene, p->doubt);
        if (p->problem[0] != '\0')
            fprintf(file, "- %s, %s, %.0e: %s\n", p->scene, p->mode, p->asked, p->problem);
        if (!point_counts(p) || point_error(p) <= p->asked)
            continue;
        fprintf(file, "- %s, %s: %.0e asked, %.1e delivered\n", p->scene, p->mode, p->asked, point_error(p));
        exceeded++;
    }
    return exceeded;
}
