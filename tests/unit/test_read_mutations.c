/* Damaged copies of valid files: whatever is read, there is no crash, no leak and a message with every refusal. The
 * damage is deterministic. */
#include "deasim/scene.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "scene_files.h"

static const char *const damaged[] = {"scene.yaml", "device.yaml", "material.yaml"};

#define LONGEST 2048

static void read_once(long *good, long *refused) {
    struct dea_scene scene;
    struct dea_error error = {0};
    enum dea_status status = dea_scene_read("scene.yaml", NULL, 0, &scene, &error);
    if (status == DEA_OK) {
        const struct dea_device *device = &scene.devices[0].device;
        /* accepted means usable: nothing that is not a number got through */
        assert_true(isfinite(device->width) && device->width > 0 && isfinite(device->stiffness));
        assert_true(isfinite(scene.stop) && scene.stop > 0 && scene.accuracy > 0);
        (*good)++;
    } else {
        assert_int_equal(status, DEA_ERR_INPUT);
        assert_true(strlen(error.text) > 10);
        (*refused)++;
    }
    dea_scene_clear(&scene);
}

static void survives_truncation(void **state) {
    (void)state;
    long good = 0, refused = 0;
    for (size_t f = 0; f < sizeof damaged / sizeof damaged[0]; f++) {
        const char *text = original_text(damaged[f]);
        for (size_t length = 0; length < strlen(text); length++) {
            write_bytes(damaged[f], text, length);
            read_once(&good, &refused);
        }
        write_text(damaged[f], text);
    }
    assert_true(refused > 500);
    read_once(&good, &refused);
    assert_true(good > 0);
}

static void survives_changed_bytes(void **state) {
    (void)state;
    uint64_t random = 88172645463325252u; /* xorshift64, Marsaglia 2003 */
    long good = 0, refused = 0;
    for (size_t f = 0; f < sizeof damaged / sizeof damaged[0]; f++) {
        const char *text = original_text(damaged[f]);
        size_t length = strlen(text);
        for (int round = 0; round < 600; round++) {
            char changed[LONGEST];
            memcpy(changed, text, length + 1);
            for (int flips = 0; flips <= round % 4; flips++) {
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                static const char liked[] = "[]{}:,&*!|>'\"#%@-.\t\n 0e9~?";
                size_t at = (size_t)(random >> 20) % length;
                changed[at] = (random & 1) != 0 ? liked[(random >> 8) % (sizeof liked - 1)]
                                                : (char)(changed[at] ^ (1 << ((random >> 8) % 8)));
            }
            write_bytes(damaged[f], changed, length);
            read_once(&good, &refused);
        }
        write_text(damaged[f], text);
    }
    assert_true(refused > 1000);
    assert_true(good > 10);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(survives_truncation),
        cmocka_unit_test(survives_changed_bytes),
    };
    return cmocka_run_group_tests(tests, enter_scene_folder, leave_scene_folder);
}
