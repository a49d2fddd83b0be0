/*
 * Where pages go; see page_output.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "page_output.h"

#include "page_picture.h"
#include "tool.h"

#include <errno.h>
#include <string.h>

bool page_output_begin(page_output *output, const char *html_path, const char *png_path)
{
    char error[MESH_FILE_ERROR_SIZE];
    const char *path = html_path;
    memset(output, 0, sizeof *output);
    output->html_path = html_path;
    output->png_path = png_path;
    if (!path && !png_path) return true;
    if (!path) {
        if (!page_picture_begin(output->drawn_path, sizeof output->drawn_path, error)) {
            tool_error("%s", error);
            output->drawn_path[0] = 0;
            return false;
        }
        path = output->drawn_path;
    }
    output->page = page_open(path);
    if (!output->page) tool_error("%s: cannot be written: %s", path, strerror(errno));
    return output->page != NULL;
}

bool page_output_end(page_output *output)
{
    char error[MESH_FILE_ERROR_SIZE];
    const bool has_page = output->page != NULL;
    bool done = true;
    if (has_page && !page_close(output->page)) {
        tool_error("%s: could not be written to the end",
                   output->html_path ? output->html_path : output->drawn_path);
        done = false;
    }
    output->page = NULL;
    if (done && has_page && output->png_path) {
        done = page_picture_draw(output->drawn_path, output->png_path, error);
        if (!done) tool_error("%s", error);
    }
    if (output->drawn_path[0]) page_picture_end(output->drawn_path);
    return done;
}
