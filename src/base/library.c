/* Shared libraries loaded when they are first needed. */
#include "base/library.h"

#include <dlfcn.h>
#include <string.h>

enum dea_status dea_library_load(const char *file, const char *package, const struct dea_library_function *functions,
                                 size_t count, struct dea_error *error) {
    void *library = dlopen(file, RTLD_LAZY | RTLD_LOCAL);
    for (size_t i = 0; library != NULL && i < count; i++) {
        void *address = dlsym(library, functions[i].name);
        if (address == NULL)
            library = NULL;
        else
            memcpy(functions[i].pointer, &address, sizeof address); /* POSIX: both kinds of pointer are alike */
    }
    if (library != NULL)
        return DEA_OK;
    const char *why = dlerror();
    return dea_fail(error, DEA_ERR_INTERNAL, "%s; install the package %s", why != NULL ? why : file, package);
}
