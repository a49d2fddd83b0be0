/*
 * Prints JSON; see tool_json.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tool_json.h"

#include "tool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

cJSON *tool_json_object(const char *type)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "schema", TOOL_JSON_SCHEMA);
    cJSON_AddStringToObject(object, "version", sc_version_string());
    cJSON_AddStringToObject(object, "type", type);
    return object;
}

cJSON *tool_json_refusal(const char *type, const char *path, const char *error)
{
    cJSON *object = tool_json_object(type);
    cJSON_AddStringToObject(object, "file", path);
    cJSON_AddStringToObject(object, "status", "error");
    cJSON_AddStringToObject(object, "error", error);
    return object;
}

/* How many bytes of a string that ends in 0 are a character in UTF-8; 0: none are. */
static size_t character_length(const char *text)
{
    const unsigned char *s = (const unsigned char *)text;
    const size_t length = s[0] < 0x80 ? 1 : s[0] < 0xe0 ? 2 : s[0] < 0xf0 ? 3 : 4;
    if (length > 1 && (s[0] < 0xc2 || s[0] > 0xf4)) return 0;
    for (size_t i = 1; i < length; i++) {
        if ((s[i] & 0xc0) != 0x80) return 0;
    }
    /* longer than need be, half of a pair of UTF-16, or beyond the last one */
    if ((s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xed && s[1] > 0x9f) ||
        (s[0] == 0xf0 && s[1] < 0x90) || (s[0] == 0xf4 && s[1] > 0x8f))
        return 0;
    return length;
}

char *tool_json_line(cJSON *object, size_t *size)
{
    char *text = cJSON_PrintUnformatted(object);
    cJSON_Delete(object);
    const size_t length = text ? strlen(text) : 0;
    /* a byte of Latin-1 becomes two */
    char *line = text && length < SIZE_MAX / 2 - 1 ? (char *)malloc(2 * length + 2) : NULL;
    *size = 0;
    for (const char *next = text; line && *next;) {
        const size_t bytes = character_length(next);
        const unsigned byte = (unsigned char)*next;
        if (bytes == 0) {
            line[(*size)++] = (char)(0xc0 | byte >> 6);
            line[(*size)++] = (char)(0x80 | (byte & 0x3f));
        } else {
            memcpy(line + *size, next, bytes);
            *size += bytes;
        }
        next += bytes ? bytes : 1;
    }
    cJSON_free(text);
    if (!line) {
        tool_error("out of memory");
        return NULL;
    }
    line[(*size)++] = '\n';
    line[*size] = '\0';
    return line;
}

bool tool_json_print(cJSON *object)
{
    size_t size;
    char *line = tool_json_line(object, &size);
    if (line) fwrite(line, 1, size, stdout);
    free(line);
    return line != NULL;
}

/* A < stands in names only, which may write it as they like. */
bool tool_json_write(cJSON *object, FILE *file)
{
    size_t size;
    char *line = tool_json_line(object, &size);
    for (size_t i = 0; line && i + 1 < size; i++) {
        if (line[i] == '<')
            fputs("\\u003c", file);
        else
            fputc(line[i], file);
    }
    free(line);
    return line != NULL;
}
