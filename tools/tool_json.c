/*
 * Prints JSON; see tool_json.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool_json.h"

#include "tool.h"

#include <stdio.h>

cJSON *tool_json_object(const char *type)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "schema", TOOL_JSON_SCHEMA);
    cJSON_AddStringToObject(object, "version", sc_version_string());
    cJSON_AddStringToObject(object, "type", type);
    return object;
}

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
