/* What accuracy scenes deliver for what is asked, in every mode that applies, against references. */
#ifndef DEASIM_BENCH_ACCURACY_H
#define DEASIM_BENCH_ACCURACY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { MAX_COLUMNS = 64, PATH_ROOM = 1024, FIRST_DECADE = 2, LAST_DECADE = 6 };

/* Displacements and port voltages of every device over the samples of a run. */
struct rows {
    size_t count;
    int columns;                  /* signals */
    bool is_port[MAX_COLUMNS];    /* otherwise a displacement */
    int device[MAX_COLUMNS];      /* which device, counted from 0 */
    int zone[MAX_COLUMNS];        /* of a port */
    double *time;                 /* s, owned */
    double *signals[MAX_COLUMNS]; /* m and V, owned */
};

/* Reads result.raw of a run. */
bool rows_read(const char *folder, struct rows *rows);
void rows_clear(struct rows *rows);

/* Largest relative L2 errors over the times both have: of a displacement, and of a port voltage, the latter relative to
 * the largest port of its device. NAN when fewer than nine tenths of the samples are at times of the reference. */
struct delivered {
    double x, ports;
};
struct delivered rows_compare(const struct rows *rows, const struct rows *reference);

/* A run of the program. */
struct run {
    bool good;
    char mode[16], problem[96];
    double imbalance, seconds; /* s, of the whole process */
    double steps;
    int impacts; /* on end stops */
    struct rows rows;
};
/* `engine` as on the command line. Every signal is written, also where the scene picks some. */
void run_scene(const char *program, const char *scene, const char *engine, double accuracy, double sample,
               const char *folder, double limit, struct run *run);
void run_clear(struct run *run);

/* The independent program on a native scene, in a process of its own, with the columns of another run; false when it
 * cannot, or not in time. */
bool run_independent(const char *scene, double stop, size_t samples, const char *folder, double limit,
                     const struct rows *like, struct rows *rows);

/* One measured run. */
struct point {
    char scene[128], mode[16];
    double asked, imbalance, seconds, steps;
    struct delivered delivered;
    char problem[96];    /* empty: the run ended */
    char reference[16];  /* what it was compared with: independent, or a mode */
    double reference_at; /* A of the reference; 0 for the independent program */
    double doubt;        /* difference of the reference to a second one */
    bool sensitive;      /* many impacts on end stops: not judged */
    bool unsure;         /* the reference is hardly better than what was asked: not judged */
};

struct points {
    struct point *points; /* owned */
    size_t count, room;
};

double point_error(const struct point *point);
/* The point says something: it ran, it is judged, and something moves. */
bool point_counts(const struct point *point);

void write_csv(const struct points *points, FILE *file);
/* Medians and worst of each mode and accuracy, then the points that exceed what was asked. Returns how many do. */
int write_table(const struct points *points, FILE *file);

#endif
