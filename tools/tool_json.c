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

/* A < stands in names only, which may write it as they like. */
static void write_text(const char *text, bool in_page, FILE *file)
{
    while (*text) {
        const size_t length = character_length(text);
        const unsigned byte = (unsigned char)*text;
        if (length == 0) {
            fputc((int)(0xc0 | byte >> 6), file);
            fputc((int)(0x80 | (byte & 0x3f)), file);
        } else if (in_page && byte == '<') {
            fputs("\\u003c", file);
        } else {
            fwrite(text, 1, length, file);
        }
        text += length ? length : 1;
    }
}

static bool write_object(cJSON *object, bool in_page, FILE *file)
{
    char *text = cJSON_PrintUnformatted(object);
    if (text)
        write_text(text, in_page, file);
    else
        tool_error("out of memory");
    cJSON_free(text);
    cJSON_Delete(object);
    return text != NULL;
}

bool tool_json_print(cJSON *object)
{
    const bool written = write_object(object, false, stdout);
    if (written) putchar('\n');
    return written;
}

bool tool_json_write(cJSON *object, FILE *file)
{
    return write_object(object, true, file);
}
