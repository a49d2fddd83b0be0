/*
 * A picture of a page: three views of its first frame, side by side, as PNG.
 *
 * SPDX-License-Identifier: MIT
 *
 * A Chromium that is installed draws the page itself, without a window: so the picture shows what
 * the page does, and there is no second renderer to keep. The environment's SC_BROWSER names it;
 * otherwise its usual names are tried.
 */
#ifndef TOOLS_PAGE_PICTURE_H
#define TOOLS_PAGE_PICTURE_H

#include "mesh_file.h"

/* A new folder for a page, which is to be written to path (it has `size` bytes). On failure error
   says why. */
bool page_picture_begin(char *path, size_t size, char error[MESH_FILE_ERROR_SIZE]);

/* Draws the page at that path to a file; otherwise error says why not, within a minute or so. */
bool page_picture_draw(const char *path, const char *png_path, char error[MESH_FILE_ERROR_SIZE]);

/* Removes the page and its folder. */
void page_picture_end(const char *path);

#endif /* TOOLS_PAGE_PICTURE_H */
