/* Scenes for the tests of the native core: named ones, and random ones from a seed. */
#ifndef DEASIM_TEST_SCENES_H
#define DEASIM_TEST_SCENES_H

#include "deasim/scene.h"

enum { TEST_BRANCHES = 40, TEST_POINTS = 16 };

/* A scene with its device, branches and points in one place; not copyable. */
struct test_scene {
    struct dea_scene scene;
    struct dea_scene_device device;
    struct dea_branch branches[TEST_BRANCHES];
    double times[3][TEST_POINTS], values[3][TEST_POINTS];
};

enum test_scene_name {
    SCENE_RC_STEP,      /* 0 to 3300 V through 1 MOhm, 120 ms, two zones, one linear branch */
    SCENE_RC_UNDAMPED,  /* the same without the branch */
    SCENE_SINE,         /* one side, bias and sine, two branches */
    SCENE_ANTIPHASE,    /* both sides about a bias */
    SCENE_VISCOUS,      /* no mass, damping */
    SCENE_ALGEBRAIC,    /* no mass, no damping, charge behind a resistance */
    SCENE_RAMP,         /* ideal source, 5 ms ramp */
    SCENE_STIFF_BRANCH, /* tau 1e-6 s */
    SCENE_VHB,          /* Arruda-Boyce, three branches, trapezoid over 20 s */
    SCENE_SLACK,        /* the passive zone goes slack and taut again and again */
    SCENE_SLACK_ACTIVE, /* the driven zone buckles */
    SCENE_STOPS,        /* lossy end stop hit by a step */
    SCENE_AMPLIFIER,    /* slew, pole and current limit */
    SCENE_SLEW,         /* slew limit alone */
    SCENE_LEAKAGE,      /* exponential, with sheet electrodes */
    SCENE_LOAD,         /* load waveform at a held voltage */
    SCENE_SMALL,        /* 10 V */
    SCENE_ATTENUATED,   /* x far below what the voltage could do */
    SCENE_RINGING,      /* 200 undamped cycles */
    SCENE_FRESH,        /* prestretch just applied */
    SCENE_PULSES,       /* pulse train, many corners */
    SCENE_COUNT
};

extern const char *const test_scene_names[SCENE_COUNT];

/* Design C of physics: Sylgard 186, 4 + 4 mm, both electroded, no branches, nothing driven, 120 ms. */
void build_design_c(struct test_scene *s);
void build_scene(struct test_scene *s, enum test_scene_name name);

/* Reads a scene of the tree, "tests/cases/x.yaml"; aborts when it is no good. The caller clears it. */
void read_tree_scene(const char *path_from_top, struct dea_scene *scene);

/* A random scene; the same seed gives the same one. Prepared; may be beyond what the device can hold. */
void build_random_scene(struct test_scene *s, unsigned seed);

/* Adds a branch; call prepare_scene after the last edit of the device. */
void add_branch(struct test_scene *s, enum dea_branch_kind kind, double mu, double tau, double jm);
void prepare_scene(struct test_scene *s);

struct dea_waveform dc_wave(double level);
struct dea_waveform step_wave(double low, double high, double rise);
struct dea_waveform sine_wave(double offset, double amplitude, double frequency);
void drive_zone(struct test_scene *s, int zone, struct dea_waveform waveform, double resistance);

#endif
