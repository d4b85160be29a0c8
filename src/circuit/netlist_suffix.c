/* Values whose SPICE suffix hardly means what was written: 1M is a thousandth, 1F a millionth of a billionth. */
#include "circuit/netlist_internal.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum dea_status dea_netlist_check_suffix(struct dea_netlist_job *job, int index) {
    const char *cursor = job->netlist->lines[index].text;
    char token[DEA_TOKEN_MAX], kind = (char)tolower((unsigned char)cursor[0]);
    for (int i = 0; i < 3; i++)
        if (!dea_netlist_token(&cursor, token))
            return DEA_OK;
    cursor += strspn(cursor, " \t");
    char *end;
    double value = strtod(cursor, &end);
    if (end == cursor || !isdigit((unsigned char)end[-1]))
        return DEA_OK;
    int length = (int)strcspn(cursor, " \t");
    if (kind == 'r' && *end == 'M' && strncasecmp(end, "meg", 3) != 0 && strncasecmp(end, "mil", 3) != 0)
        return dea_netlist_warn(job, index, "%.*s is %g milliohm: M is milli in SPICE, Meg is a million", length,
                                cursor, value);
    if (kind == 'c' && *end == 'F')
        return dea_netlist_warn(job, index, "%.*s is %g femtofarad: F behind a number is femto in SPICE", length,
                                cursor, value);
    return DEA_OK;
}
