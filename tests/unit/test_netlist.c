/* Netlists are untrusted: what is read, what is found in them, what is refused and where the message points. */
#include "circuit/netlist.h"

#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

/* Every test works in a folder of its own, which is the current one: outer/inner, netlists in inner. */
struct place {
    char outer[64], back[1024];
};

static int enter_folder(void **state) {
    struct place *place = calloc(1, sizeof *place);
    if (place == NULL || getcwd(place->back, sizeof place->back) == NULL)
        return -1;
    strcpy(place->outer, "/tmp/deasim-netlist-XXXXXX");
    *state = place;
    return mkdtemp(place->outer) == NULL || chdir(place->outer) != 0 || mkdir("inner", 0700) != 0 ||
           chdir("inner") != 0;
}

static int leave_folder(void **state) {
    struct place *place = *state;
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", place->outer);
    int failed = chdir(place->back) != 0 || system(command) != 0;
    free(place);
    return failed;
}

static void write_file(const char *path, const char *text, size_t size) {
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, size), size);
    close(file);
}

static const struct dea_netlist_device two_zones = {"DEA", 2, {"left", "right"}};
static const struct dea_netlist_device one_zone = {"DEA", 1, {"left", NULL}};

static enum dea_status read_text(const char *text, const struct dea_netlist_device *device, bool trusted,
                                 struct dea_netlist *netlist, struct dea_error *error) {
    const struct dea_netlist_options options = {.trusted = trusted, .devices = device, .device_count = device != NULL};
    write_file("main.cir", text, strlen(text));
    error->text[0] = '\0';
    return dea_netlist_read("main.cir", &options, netlist, error);
}

static void expect_good(const char *text, const struct dea_netlist_device *device, struct dea_netlist *netlist) {
    struct dea_error error;
    if (read_text(text, device, false, netlist, &error) != DEA_OK)
        fail_msg("%s", error.text);
}

static void expect_refused(const char *text, const struct dea_netlist_device *device, const char *begins,
                           const char *says) {
    struct dea_netlist netlist;
    struct dea_error error;
    enum dea_status status = read_text(text, device, false, &netlist, &error);
    if (status != DEA_ERR_INPUT || strncmp(error.text, begins, strlen(begins)) != 0 || strstr(error.text, says) == NULL)
        fail_msg("netlist:\n%s\nexpected \"%s ... %s\", got %d \"%s\"", text, begins, says, status, error.text);
    dea_netlist_clear(&netlist);
}

/* ---- what is read ---- */

static void test_lines_are_joined_and_placed(void **state) {
    (void)state;
    struct dea_netlist netlist;
    expect_good("V1 this is the title 0 1\r\n* comment\r\nR1 a 0 ; inline\r\n* between\r\n+ 1k $ more\r\n\r\n"
                "Xdea a 0 pos dea // no more\r\n.end\r\nrubbish <<<\r\n",
                &one_zone, &netlist);
    assert_int_equal(netlist.line_count, 3);
    assert_string_equal(netlist.lines[0].text, "V1 this is the title 0 1");
    assert_false(netlist.lines[0].passed);
    assert_string_equal(netlist.lines[1].text, "R1 a 0  1k");
    assert_int_equal(netlist.lines[1].line, 3);
    assert_string_equal(netlist.lines[2].text, "Xdea a 0 pos dea");
    assert_int_equal(netlist.lines[2].line, 7);
    dea_netlist_clear(&netlist);
}

static void test_spice_numbers(void **state) {
    (void)state;
    static const struct {
        const char *text;
        double value;
    } good[] = {{"1", 1.0},        {"10V", 10.0}, {"1M", 1e-3},    {"1Meg", 1e6}, {"2.5megohm", 2.5e6}, {"-3k", -3e3},
                {"1e-3", 1e-3},    {"1u", 1e-6},  {"100ns", 1e-7}, {"4p", 4e-12}, {".5", 0.5},          {"+2G", 2e9},
                {"1mil", 2.54e-5}, {"1T", 1e12},  {"3f", 3e-15},   {"7a", 7e-18}};
    static const char *const bad[] = {"", "k", "1k2", "0x10", "nan", "inf", "1e999", "{a}", "--1"};
    double value;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_true(dea_spice_number(good[i].text, &value));
        assert_true(fabs(value - good[i].value) <= 1e-15 * fabs(good[i].value));
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_false(dea_spice_number(bad[i], &value));
}

static void test_cards_are_found(void **state) {
    (void)state;
    struct dea_netlist netlist;
    expect_good("t\nV2 c 0 PWL(0 0 1m 1 1m 2 {x} 3 r=0)\nV3 d 0 pwl 0 0 1m 1 td=2\nB1 a 0 V=temper*2\nR1 a 0 1k\nV1 a "
                "0 1\n.measure tran x FIND par('v(a)*2') WHEN v(a)=1\n",
                NULL, &netlist);
    dea_netlist_clear(&netlist);
    expect_good(
        "t\n.TRAN 1u 20ms 0 5u UIC\n.ic v(a)=1k V(xarm.b) = 2.5 v(c)={vc}\n.measure tran Rise trig v(a) val=1 rise=1 "
        "targ v(a) val=2 rise=1\n.meas tran peak max v(a)\n.measure ac gone max v(a)\n.save v(a)\n.print tran v(a)\n"
        ".ac dec 10 1 1k\n.options reltol=1e-5 interp Method = gear savecurrents\nR1 a 0 1k\nA1 a b amp\n",
        NULL, &netlist);
    assert_true(netlist.tran.present && netlist.tran.numeric && netlist.tran.uic);
    assert_true(netlist.tran.step == 1e-6 && fabs(netlist.tran.stop - 20e-3) < 1e-15 && netlist.tran.start == 0.0);
    assert_true(fabs(netlist.tran.max_step - 5e-6) < 1e-18);
    assert_int_equal(netlist.initial_count, 2);
    assert_string_equal(netlist.initials[0].node, "a");
    assert_true(netlist.initials[0].value == 1000.0);
    assert_string_equal(netlist.initials[1].node, "xarm.b");
    assert_int_equal(netlist.measure_count, 2);
    assert_string_equal(netlist.measures[0], "rise");
    assert_string_equal(netlist.measures[1], "peak");
    assert_true(netlist.has_event_parts);
    for (int i = 0; i < netlist.line_count; i++) {
        const char *text = netlist.lines[i].text;
        if (strncmp(text, ".opt", 4) == 0)
            assert_string_equal(text, ".options reltol=1e-5 method=gear");
        bool own = strncmp(text, ".TRAN", 5) == 0 || strncmp(text, ".save", 5) == 0 || strncmp(text, ".print", 6) == 0;
        if (own || strncmp(text, ".ac", 3) == 0 || strncmp(text, ".measure ac", 11) == 0)
            assert_false(netlist.lines[i].passed);
    }
    static const char *const warnings[] = {".measure ac left out", ".ac left out", "interp left out",
                                           "savecurrents left out"};
    assert_int_equal(netlist.warning_count, 4);
    for (int i = 0; i < 4; i++)
        assert_non_null(strstr(netlist.warnings[i], warnings[i]));
    dea_netlist_clear(&netlist);
}

static void test_instances_are_flattened(void **state) {
    (void)state;
    struct dea_netlist netlist;
    expect_good("t\n.global rail\nXa l 0 r gnd p Dea\nXarm one in arm k=3\nX2 (two, in) ARM\n"
                ".subckt arm out in params: k=1\nXdea out mid rail 0 pos DEA\nR1 mid 0 1k\n"
                ".subckt inner a\nR1 a 0 1\n.ends\nX9 out inner\n.ends arm\n",
                &two_zones, &netlist);
    assert_int_equal(netlist.instance_count, 3);
    static const char *const expected[3][6] = {{"xa", "l", "0", "r", "0", "p"},
                                               {"xarm.xdea", "one", "xarm.mid", "rail", "0", "xarm.pos"},
                                               {"x2.xdea", "two", "x2.mid", "rail", "0", "x2.pos"}};
    for (int i = 0; i < 3; i++) {
        assert_string_equal(netlist.instances[i].path, expected[i][0]);
        for (int pin = 0; pin < 5; pin++)
            assert_string_equal(netlist.instances[i].nodes[pin], expected[i][pin + 1]);
    }
    assert_int_equal(netlist.lines[netlist.instances[1].line].line, 7);
    dea_netlist_clear(&netlist);
}

static void test_includes_and_sections(void **state) {
    (void)state;
    struct dea_netlist netlist;
    assert_int_equal(mkdir("lib", 0700), 0);
    const char *lib = ".lib fast\nRfast a 0 1\n.endl\n.lib slow\nRslow a 0 2\n.include \"deep file.inc\"\n.endl\n";
    write_file("lib/parts.lib", lib, strlen(lib));
    write_file("lib/deep file.inc", "* x\nRdeep a 0\n+ 3\n", 18);
    expect_good("t\n.lib 'lib/parts.lib' SLOW\nXdea a 0 pos DEA\n", &one_zone, &netlist);
    assert_int_equal(netlist.line_count, 4);
    assert_string_equal(netlist.lines[1].text, "Rslow a 0 2");
    assert_string_equal(netlist.lines[2].text, "Rdeep a 0  3");
    int line;
    assert_string_equal(dea_netlist_place(&netlist, 2, &line), "lib/deep file.inc");
    assert_int_equal(line, 2);
    dea_netlist_clear(&netlist);
    expect_refused("t\n.lib lib/parts.lib typical\n", NULL, "main.cir:2: ", "no section typical in lib/parts.lib");
}

static void test_model_files_are_found(void **state) {
    (void)state;
    struct dea_netlist netlist;
    assert_int_equal(mkdir("waves", 0700), 0);
    write_file("waves/data.txt", "0 0\n", 4);
    write_file("waves/Data.txt", "0 0\n", 4);
    const char *part = ".model src filesource (file=\"data.txt\" amploffset=[0])\n";
    write_file("waves/part.inc", part, strlen(part));
    expect_good("t\n.include waves/part.inc\nA1 %v([a]) src\n.model s2 d_source(input_file = waves/data.txt)\n", NULL,
                &netlist);
    assert_string_equal(netlist.lines[1].text, ".model src filesource (file=\"waves/data.txt\" amploffset=[0])");
    assert_string_equal(netlist.lines[3].text, ".model s2 d_source(input_file = \"waves/data.txt\")");
    assert_true(netlist.has_event_parts);
    dea_netlist_clear(&netlist);
    expect_refused("t\n.model s2 d_source(input_file = waves/Data.txt)\n", NULL, "main.cir:2: ", "lower case");
}

/* ---- what is refused ---- */

static void test_bad_netlists(void **state) {
    (void)state;
    static const struct {
        const char *text, *begins, *says;
    } cases[] = {
        /* running commands */
        {"t\nR1 a 0 1\n.control\nshell touch pwned\n.endc\n", "main.cir:3: ", ".control blocks are refused"},
        {"t\nR1 a 0 1\n.CONTROL\nshell touch pwned\n.ENDC\n", "main.cir:3: ", ".control blocks are refused"},
        {"t\n  .control\n", "main.cir:2: ", ".control blocks are refused"},
        {"t\n*# shell touch pwned\n", "main.cir:2: ", "lines beginning with *#"},
        {"t\n.con\\\\\ntrol\n", "main.cir:2: ", "not with \\\\"},
        {"t\nR1 a 0 1\\\\ \v\n", "main.cir:2: ", "not with \\\\"},
        {"t\nR1 a 0 1\\\\ ; more\n", "main.cir:2: ", "not with \\\\"},
        {"t\n.con\n+trol\n", "main.cir:2: ", ".con is not allowed"},
        {"t\n.exec touch pwned\n", "main.cir:2: ", ".exec is not allowed"},
        {"t\nshell touch pwned a b c\n.pre_osdi x.osdi\n", "main.cir:3: ", ".pre_osdi is not allowed"},
        {"t\n.codemodel evil.cm\n", "main.cir:2: ", ".codemodel is not allowed"},
        {"t\n!touch pwned\n", "main.cir:2: ", "not an element"},
        {"t\n`touch pwned`\n", "main.cir:2: ", "not an element"},
        {"t\n.model x d_process (process_file=\"sh\")\n", "main.cir:2: ", "start programs"},
        {"t\n.model x d_cosim (simulation=\"./evil.so\")\n", "main.cir:2: ", "start programs"},
        {"t\n.model x \"d_cosim\" (simulation=\"./evil.so\")\n", "main.cir:2: ", "d_cosim are refused"},
        {"t\n.foo\n", "main.cir:2: ", ".foo is not allowed"},
        /* files */
        {"t\n.include ../outside.inc\n", "main.cir:2: ", "outside the netlist's folder"},
        {"t\n.include /etc/passwd\n", "main.cir:2: ", "outside the netlist's folder"},
        {"t\n.include link.inc\n", "main.cir:2: ", "outside the netlist's folder"},
        {"t\n.include ~/x.inc\n", "main.cir:2: ", "taken literally"},
        {"t\n.include $HOME/x.inc\n", "main.cir:2: ", "taken literally"},
        {"t\n.lib ../outside.inc tt\n", "main.cir:2: ", "outside the netlist's folder"},
        {"t\n.include missing.inc\n", "main.cir:2: ", "cannot open missing.inc: No such file"},
        {"t\n.include\n", "main.cir:2: ", "needs one file name"},
        {"t\n.include folder\n", "folder: ", "not a regular file"},
        {"t\n.model s filesource (file=\"../outside.inc\")\n", "main.cir:2: ", "outside the netlist's folder"},
        {"t\n.model s d_source (input_file = /etc/passwd)\n", "main.cir:2: ", "outside the netlist's folder"},
        {"t\n.model s table2d (FILE=\"/etc/passwd\")\n", "main.cir:2: ", "outside the netlist's folder"},
        {"t\n.include self.inc\n", "self.inc:1: ", "endless .include: self.inc <- self.inc <- main.cir"},
        {"t\n.include ping.inc\n", "pong.inc:2: ", "endless .include: ping.inc <- pong.inc <- ping.inc <- main.cir"},
        /* shape */
        {"t\n", "main.cir: ", "no element"},
        {"t\n+ 1\n", "main.cir:2: ", "continuation '+' without a line before it"},
        {"t\nR1 a 0 10\xc2\xb5\n", "main.cir:2: ", "outside ASCII (for micro write u)"},
        {"t\n\nR1 a \x01 0 1\n", "main.cir:3: ", "not a text file (byte 0x01)"},
        {"t\nV1 a 0 external\n", "main.cir:2: ", "EXTERNAL sources are refused"},
        {"t\nV1 a 0 dc 0 portnum 1\n", "main.cir:2: ", "portnum is refused"},
        {"t\nV1 a 0 PWL(0 0 1m 1 0.5m 2)\n", "main.cir:2: ", "PWL: the time 0.5m goes back"},
        {"t\nV1 a 0 PWL(0 0 1m 1 2m)\n", "main.cir:2: ", "PWL: the time 2m has no value"},
        {"t\n.lib tt\n", "main.cir:2: ", ".lib needs a file and a section"},
        {"t\nR1 a 0\n", "main.cir:2: ", "r1: nodes or a value are missing; written as in R1 p n 1k"},
        {"t\nV1 a\n", "main.cir:2: ", "v1: nodes or a value are missing; written as in V1 p n 5"},
        {"t\nB1 a V=3\n", "main.cir:2: ", "b1: nodes or a value are missing"},
        {"t\nK1 L1 0.9\n", "main.cir:2: ", "k1: nodes or a value are missing"},
        {"t\nM1 d g m\n", "main.cir:2: ", "m1: nodes or a value are missing"},
        /* transient and measures */
        {"t\n.tran 1u\n", "main.cir:2: ", ".tran needs tstep and tstop"},
        {"t\n.tran 1u 1m\n.tran 1u 2m\n", "main.cir:3: ", "a second .tran; the first is at main.cir:2"},
        {"t\n.tran 1u abc\n", "main.cir:2: ", "abc is not a number"},
        {"t\n.tran 0 1m\n", "main.cir:2: ", "tstep > 0"},
        {"t\n.tran 1u 1m 2m\n", "main.cir:2: ", "tstart < tstop"},
        {"t\n.tran 1u 1m 0 1u 5\n", "main.cir:2: ", "a word too many"},
        {"t\n.measure tran a max v(a)\n.measure tran A max v(b)\n", "main.cir:3: ", "a second .measure named a"},
        {"t\n.measure tran a\n", "main.cir:2: ", ".measure a: say what to measure"},
        {"t\n.measure tran a max\n", "main.cir:2: ", ".measure a: say what to measure"},
        {"t\n.measure tran a v(b)\n", "main.cir:2: ", ".measure a: say what to measure"},
        {"t\n.measure tran $min min v(a)\n", "main.cir:2: ", "$min: a name is made of letters"},
        /* what crashes ngspice or keeps it for ever */
        {"t\nB1 a 0 V=min(max(V(b),1),V(c\n", "main.cir:2: ", "'(' is not closed"},
        {"t\nB1 a 0 V=V(b))\n", "main.cir:2: ", "')' without its opening bracket"},
        {"t\nB1 a 0 V={V(b)\n", "main.cir:2: ", "'{' is not closed"},
        {"t\nB1 a 0 V={V(b})\n", "main.cir:2: ", "'}' without its opening bracket"},
        {"t\n.measure tran a max par('V(b)\n", "main.cir:2: ", "is not closed"},
        {"t\nR1 a 0 1\"0k\n", "main.cir:2: ", "a quote (\") is not closed"},
        {"t\nVin ' in 5\n", "main.cir:2: ", "a quote (') is not closed"},
        {"t\n.param va=50 fp=,1k\n", "main.cir:2: ", "separate parameters with blanks"},
        {"t\n.param va=\n", "main.cir:2: ", "a value is missing behind '='"},
        {"t\n.model d\n", "main.cir:2: ", ".model needs a name and a type"},
        {"t\n.measure tran x max par('V(p)-=V(q)')\n", "main.cir:2: ", "par('V(p)-=V(q)'): not an expression"},
        {"t\n.measure tran x max par('V(p q)')\n", "main.cir:2: ", "par('V(p q)'): not an expression"},
        {"t\n.measure tran x find v(p)\n", "main.cir:2: ", ".measure x: find needs at=.. or when .."},
        {"t\n.measure tran x find v(p)>at=1m\n", "main.cir:2: ", ".measure x: find needs at=.. or when .."},
        {"t\n.csparam a\n", "main.cir:2: ", ".csparam: written as in .csparam name={value}"},
        {"t\n.csparam\n", "main.cir:2: ", ".csparam: written as in"},
        {"t\n.ic v( )=1\n", "main.cir:2: ", ".ic: v() names no node"},
        {"t\n.nodeset v(a)=1 v()=2\n", "main.cir:2: ", ".nodeset: v() names no node"},
        {"t\nR1 Temper 0 1k\n", "main.cir:2: ", "r1: no node may be named temper"},
        {"t\nXdea a 0 temper DEA\n", "main.cir:2: ", "xdea: no node may be named temper"},
        {"t\n.measure tran\n", "main.cir:2: ", ".measure needs an analysis and a name"},
    };
    write_file("../outside.inc", "R9 a 0 1\n", 9);
    write_file("self.inc", ".include self.inc\n", 18);
    write_file("ping.inc", ".include pong.inc\n", 18);
    write_file("pong.inc", "*\n.include ping.inc\n", 20);
    assert_int_equal(mkdir("folder", 0700), 0);
    assert_int_equal(symlink("../outside.inc", "link.inc"), 0);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        expect_refused(cases[i].text, NULL, cases[i].begins, cases[i].says);
    assert_int_not_equal(access("pwned", F_OK), 0);
}

static void test_bad_device_calls(void **state) {
    (void)state;
    static const struct {
        const char *text, *begins, *says;
    } cases[] = {
        {"t\nR1 a 0 1\n", "main.cir: ",
         "device DEA is never used; call it as Xname nodes DEA, nodes for: left p, left n, right p, right n, pos"},
        {"t\nXdea a 0 pos DEA\n",
         "main.cir:2: ", "xdea: device DEA has 5 pins (left p, left n, right p, right n, pos), 3 nodes are given"},
        {"t\nXdea a 0 b 0 pos extra DEA\n", "main.cir:2: ", "5 pins (left p, left n, right p, right n, pos), 6 nodes"},
        {"t\nXdea a 0 b 0 pos DEA m=2\n", "main.cir:2: ", "takes no parameters"},
        {"t\n.subckt dea a b c d e\n.ends\n", "main.cir:2: ", "it is supplied"},
        {"t\n.if (1)\nXdea a 0 b 0 pos DEA\n.endif\n", "main.cir:3: ", "inside .if"},
        {"t\n.subckt arm a b\nXdea a 0 b 0 pos DEA\n.ends\nX1 a b c arm\n",
         "main.cir:5: ", "subcircuit arm has 2 pins, 3 nodes are given"},
        {"t\n.subckt arm a b\nXdea a 0 b 0 pos DEA\n.ends\nR1 a 0 1\n", "main.cir: ", "never used"},
        {"t\n.subckt arm a\nXdea a 0 a 0 pos DEA\nX2 a arm\n.ends\nX1 a arm\n",
         "main.cir:4: ", "does arm call itself?"},
        {"t\n.subckt arm a\nXdea a 0 a 0 pos DEA\n", "main.cir:2: ", ".subckt arm without .ends"},
        {"t\n.ends\n", "main.cir:2: ", ".ends without .subckt"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        expect_refused(cases[i].text, &two_zones, cases[i].begins, cases[i].says);
}

static void test_sizes_are_limited(void **state) {
    (void)state;
    struct dea_netlist netlist;
    struct dea_error error;
    const struct dea_netlist_options options = {0};
    /* 100 MB, sparse: refused before it is read */
    write_file("big.cir", "t\n", 2);
    assert_int_equal(truncate("big.cir", 100 << 20), 0);
    assert_int_equal(dea_netlist_read("big.cir", &options, &netlist, &error), DEA_ERR_INPUT);
    assert_non_null(strstr(
        error.text, "big.cir: a netlist with its includes may have at most 16 MB, this file has 104857600 bytes"));
    dea_netlist_clear(&netlist);
    /* many lines */
    FILE *file = fopen("long.cir", "w");
    assert_non_null(file);
    for (int i = 0; i < 100001; i++)
        fprintf(file, "R%d a 0 1\n", i);
    fclose(file);
    assert_int_equal(dea_netlist_read("long.cir", &options, &netlist, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "long.cir:100001: a netlist may have at most 100000 lines");
    dea_netlist_clear(&netlist);
    file = fopen("measures.cir", "w");
    assert_non_null(file);
    fputs("t\nR1 a 0 1\n", file);
    for (int i = 0; i < 2001; i++)
        fprintf(file, ".measure tran m%d max v(a)\n", i);
    fclose(file);
    assert_int_equal(dea_netlist_read("measures.cir", &options, &netlist, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "measures.cir:2003: a netlist may have at most 2000 .measure lines");
    dea_netlist_clear(&netlist);
    /* binary */
    write_file("noise.cir",
               "\x7f"
               "ELF\x02\x01\0\0",
               8);
    assert_int_equal(dea_netlist_read("noise.cir", &options, &netlist, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "noise.cir:1: not a text file (byte 0x02)");
    dea_netlist_clear(&netlist);
    assert_int_equal(dea_netlist_read("none.cir", &options, &netlist, &error), DEA_ERR_INPUT);
    assert_string_equal(error.text, "none.cir: No such file or directory");
    dea_netlist_clear(&netlist);
}

/* Subcircuits without end, or with too many elements when put in. */
static void test_exploding_subcircuits(void **state) {
    (void)state;
    char text[4000];
    expect_refused("t\n.subckt a n\nX1 n a\n.ends\nX1 p a\n", NULL,
                   "main.cir:3: ", "nested more than 20 deep (does a call itself?)");
    expect_refused("t\n.subckt a n\nX1 n b\n.ends\n.subckt b n\nX1 n a\n.ends\nX1 p a\n", NULL,
                   "main.cir:", "call itself?)");
    int used = snprintf(text, sizeof text, "t\n.subckt s0 n\nR1 n 0 1\n.ends\n");
    for (int i = 1; i <= 19; i++)
        used += snprintf(text + used, sizeof text - (size_t)used,
                         ".subckt s%d n\nX1 n s%d\nX2 n s%d\nX3 n s%d\n.ends\n", i, i - 1, i - 1, i - 1);
    snprintf(text + used, sizeof text - (size_t)used, "X1 p s19\n");
    expect_refused(text, NULL, "main.cir:", "the circuit has more than a million elements");
    snprintf(text + used, sizeof text - (size_t)used, "X1 p s8\n");
    struct dea_netlist netlist;
    expect_good(text, NULL, &netlist);
    dea_netlist_clear(&netlist);
}

/* Includes that double at every level end at a limit, quickly. */
static void test_exploding_includes(void **state) {
    (void)state;
    char name[32], text[128];
    for (int i = 0; i < 18; i++) {
        snprintf(name, sizeof name, "e%d.inc", i);
        int length = snprintf(text, sizeof text, ".include e%d.inc\n.include e%d.inc\n", i + 1, i + 1);
        write_file(name, text, (size_t)length);
    }
    write_file("e18.inc", "*\n", 2);
    expect_refused("t\n.include e0.inc\n", NULL, "e18.inc: ", "at most 1000 files");
}

static void test_trusted_skips_and_reads_outside(void **state) {
    (void)state;
    struct dea_netlist netlist;
    struct dea_error error;
    write_file("../outside.inc", "R9 a 0 1\n", 9);
    if (read_text(
            "t\n.include ../outside.inc\n.control\nshell touch pwned\n.endc\n*# shell touch pwned\nXdea a 0 pos DEA\n",
            &one_zone, true, &netlist, &error) != DEA_OK)
        fail_msg("%s", error.text);
    assert_int_equal(netlist.line_count, 3);
    assert_string_equal(netlist.lines[1].text, "R9 a 0 1");
    assert_int_not_equal(access("pwned", F_OK), 0);
    dea_netlist_clear(&netlist);
}

int main(void) {
#define TEST(name) cmocka_unit_test_setup_teardown(name, enter_folder, leave_folder)
    const struct CMUnitTest tests[] = {
        TEST(test_lines_are_joined_and_placed),
        TEST(test_spice_numbers),
        TEST(test_cards_are_found),
        TEST(test_instances_are_flattened),
        TEST(test_includes_and_sections),
        TEST(test_model_files_are_found),
        TEST(test_bad_netlists),
        TEST(test_bad_device_calls),
        TEST(test_sizes_are_limited),
        TEST(test_exploding_includes),
        TEST(test_exploding_subcircuits),
        TEST(test_trusted_skips_and_reads_outside),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
