/* Functions in netlists: what ngspice would crash over or never finish is refused, the rest passes. */
#include "netlist_support.h"

static void test_arguments_are_counted(void **state) {
    (void)state;
    expect("B1 b 0 V=max(V(a),1,2)\n", ":2: max() takes 2 arguments, 3 are given");
    expect("B1 b 0 V=1+exp ( V(a), 1 )\n", ":2: exp() takes 1 argument, 2 are given");
    expect("B1 b 0 I=Pow(V(a))\n", ":2: pow() takes 2 arguments, 1 is given");
    expect("B1 b 0 V=sin()\n", ":2: sin() takes 1 argument, 0 are given");
    expect("B1 b 0 V=pwl(V(a),0,0)\n", ":2: pwl() takes at least 5 arguments, 3 are given");
    expect("B1 b 0 V=pwl(V(a),1,0,0,1)\n", ":2: pwl(): its points must go up, 0 does not");
    expect("B1 b 0 V=pwl(V(a),0,0, V(c) ,1)\n", ":2: pwl(): V(c) is no constant");
    expect("B1 b 0 V=pwl(V(a)+max(1,2),-1,0, {x} , (1+2) , 1m,5)+pwl(V(c),0,0,1,1)\n", NULL);
    expect("R1 b 0 r='min(V(a))'\n", ":2: min() takes 2 arguments");
    expect(".func f(x) {abs(x,1)}\nR1 b 0 1\n", ":2: abs() takes 1 argument");
    expect("R1 b 0 1\n.measure tran m max par('exp(v(a),2)')\n", ":3: exp() takes 1 argument");
    expect("R1 b 0 1\n.measure tran m max par('max(v(a),2)')\n.measure tran n max v(b)\n", NULL);
    expect("B1 b 0 V=max(V(a,c),min(V(a),{k*(1+2)}))+2e3*sin(6.28*time)\n", NULL);
    expect("B1 b 0 V=pwl(V(a),0,0,1,1)\nE1 c 0 PWL(1) a 0 0,0 1,1\n", NULL);
    expect("V1 b 0 SIN(0,1,1k)\nV2 c 0 PWL(0 0 1m 1)\n", NULL);
    expect(".func limit(x,a,b) {min(max(x,a),b)}\n.func max(a,b,c) {a+b+c}\nB1 b 0 V=limit(V(a),0,1)+max(1,2,3)\n",
           NULL);
}

static void test_functions_end(void **state) {
    (void)state;
    expect(".func f(x) {f(x)+1}\nR1 a 0 {f(1)}\n", ":2: .func f calls itself");
    expect(".func f(x) {2*g(x)}\n.func g(x) {F(x)}\nR1 a 0 1\n", ".func f calls itself");
    expect(".func f(f) {f+1}\nR1 a 0 {f(1)}\n", NULL);
    expect(".func f\nR1 a 0 1\n", ":2: .func needs a name, parameters and a body");
    expect(".func f(x) {x+1}\n.func g(x) {f(x)+f(2)}\nR1 a 0 {g(f(g(1)))}\n", NULL);
}

static void test_growth_is_limited(void **state) {
    (void)state;
    static char text[20000];
    size_t used = (size_t)snprintf(text, sizeof text, ".func f0(x) {x+1}\n");
    for (int i = 1; i <= 25; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, ".func f%d(x) {f%d(x)+f%d(x)}\n", i, i - 1, i - 1);
    snprintf(text + used, sizeof text - used, "R1 a 0 {f4(1)}\n");
    expect(text, NULL);
    snprintf(text + used, sizeof text - used, "R1 a 0 {f25(1)}\n");
    expect(text, ":28: functions put in, the line has more than a million characters");
    /* the argument grows, not the function */
    used = (size_t)snprintf(text, sizeof text, ".func f(x) {x+x}\nR1 a 0 {");
    for (int i = 0; i < 30; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, "f(");
    used += (size_t)snprintf(text + used, sizeof text - used, "1");
    for (int i = 0; i < 30; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, ")");
    snprintf(text + used, sizeof text - used, "}\n");
    expect(text, ":3: functions put in, the line has more than a million characters");
    /* a long chain, from its end and from its beginning */
    used = (size_t)snprintf(text, sizeof text, ".func f0(x) {x}\n");
    for (int i = 1; i <= 60; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, ".func f%d(x) {f%d(x)}\n", i, i - 1);
    snprintf(text + used, sizeof text - used, "R1 a 0 1\n");
    expect(text, NULL); /* each one is measured once */
    used = 0;
    for (int i = 0; i < 60; i++)
        used += (size_t)snprintf(text + used, sizeof text - used, ".func f%d(x) {f%d(x)}\n", i, i + 1);
    snprintf(text + used, sizeof text - used, ".func f60(x) {x}\nR1 a 0 1\n");
    expect(text, ".func f50: functions nested more than 50 deep");
}

static void test_counts_are_limited(void **state) {
    (void)state;
    char *text = malloc(100000);
    assert_non_null(text);
    size_t used = 0;
    for (int i = 0; i < 1001; i++)
        used += (size_t)snprintf(text + used, 100000 - used, ".func f%d(x) {x}\n", i);
    expect(text, ":1002: a netlist may have at most 1000 functions");
    free(text);
    expect(".func f(a,b,c,d,e,f,g,h,i,j,k,l,m,n,o,p,q) {a}\n", ".func f: at most 16 parameters");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_arguments_are_counted),
        cmocka_unit_test(test_functions_end),
        cmocka_unit_test(test_growth_is_limited),
        cmocka_unit_test(test_counts_are_limited),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
