/*
 * Prints JSON; see tool_json.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool_json.h"

#include "tool.h"

#include <stdio.h>

bool tool_json_print(cJSON *object)
{
    char *text = cJSON_PrintUnformatted(object);
    if (text)
        puts(text);
    else
        tool_error("out of memory");
    cJSON_free(text);
    cJSON_Delete(object);
    return text != NULL;
}
