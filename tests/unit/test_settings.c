/* What ngspice is told at its start, and the clock it finds. */
#include "circuit/engine.h"

#include <dlfcn.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>
#include <sys/timeb.h>
#include <time.h>

#include <cmocka.h>

/* ngspice's own calls find the same function as this program's, and it tells the time of day. */
static void test_clock(void **state) {
    (void)state;
    int (*found)(struct timeb *) = NULL;
    *(void **)&found = dlsym(RTLD_DEFAULT, "ftime");
    struct dea_engine *engine = NULL;
    assert_int_equal(dea_engine_open(&engine, NULL), DEA_OK);
    dea_engine_close(engine);
    Dl_info place, program;
    assert_true(dladdr(*(void **)&found, &place) != 0);
    assert_true(dladdr(__FUNCTION__, &program) != 0);
    assert_string_equal(place.dli_fname, program.dli_fname);
    for (int i = 0; i < 3; i++) {
        struct timeb now;
        struct timespec exact;
        assert_int_equal(found(&now), 0);
        assert_int_equal(clock_gettime(CLOCK_REALTIME, &exact), 0);
        double late = (double)(exact.tv_sec - now.time) + 1e-9 * (double)exact.tv_nsec - 1e-3 * now.millitm;
        assert_true(late > -0.02 && late < 2.0); /* a test may be put aside between the two */
        nanosleep(&(struct timespec){.tv_nsec = 30000000}, NULL);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_clock)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
