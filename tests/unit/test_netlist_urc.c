/* URC lines that would keep ngspice for ever are refused with their place and what is allowed. */
#include "netlist_support.h"

#define LINE_SAYS ":2: n of a URC line must be a plain number from 1 to 200, not "
#define MODEL_SAYS ":3: k of a URC line must be a plain number from 1.2 to 1000, not "

static void test_lumps_are_limited(void **state) {
    (void)state;
    expect("U1 n k 0 n l=1 n=200\n", NULL);
    expect("U1 a b 0 m l=1\nU2 b c 0 m n 12\nU3 c d 0 m N = 0.05k\n", NULL);
    expect("U1 n k 0 n l=1 n=201\n", LINE_SAYS "\"201\"");
    expect("u1 a b 0 m N = 2e9\n", LINE_SAYS "\"2e9\"");
    expect("U1 a b 0 m n 1meg\n", LINE_SAYS "\"1meg\"");
    expect("U1 a b 0 m n=0\n", LINE_SAYS "\"0\"");
    expect("U1 a b 0 m n=-3\n", LINE_SAYS "\"-3\"");
    expect("U1 a b 0 m n=5 n=1e6\n", LINE_SAYS "\"1e6\"");
    expect("U1 a b 0 m n={10*1000}\n", LINE_SAYS "\"{10*1000}\"");
    expect("U1 a b 0 m n='many'\n", LINE_SAYS "\"'many'\"");
    expect("U1 a b 0 m l=1 n=\n", LINE_SAYS "\"\"");
}

static void test_growth_is_not_too_slow(void **state) {
    (void)state;
    expect("U1 a b 0 m\n.model m URC(k=1.2 rperl=1k)\n", NULL);
    expect("U1 a b 0 m\n.model m urc rperl=1k cperl=1p fmax=1g\n", NULL);
    expect("U1 a b 0 m\n.model m URC(rperl=1k K = 1.001)\n", MODEL_SAYS "\"1.001\"");
    expect("U1 a b 0 m\n.model m urc (k=1)\n", MODEL_SAYS "\"1\"");
    expect("U1 a b 0 m\n.model m urc k={k}\n", MODEL_SAYS "\"{k}\"");
    expect("U1 a b 0 m\n.model m urc k=1e9\n", MODEL_SAYS "\"1e9\"");
    expect("R1 a b 1\n.model m r k=1\n", NULL); /* of another kind */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lumps_are_limited),
        cmocka_unit_test(test_growth_is_not_too_slow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
