/* What the benchmarks' programs read alike. */
#ifndef DEASIM_BENCH_TEXT_H
#define DEASIM_BENCH_TEXT_H

/* A whole file as malloc'd text; NULL when it cannot be read or is empty. */
char *read_text(const char *path);

#endif
