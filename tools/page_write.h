/*
 * Writes a page to look at, in a browser and without a network: meshes that turn, with their
 * colliding faces and places, frame by frame.
 *
 * SPDX-License-Identifier: MIT
 *
 * The page is tools/page/page.html with the data at its mark, in elements that a browser does not
 * run. Each frame is written when it is added, and is decoded when it is looked at, so that a long
 * animation opens as fast as a single mesh. Frames with the same triangles share one list of them.
 *
 * What is in the data, in the order of the file:
 *
 *     data-block="mesh-M"    number of indices, then the indices, as steps
 *     data-block="frame-F"   for each vertex 16 bits of x, y and z in the frame's box: of x, then
 *                            y, then z, as steps modulo 65536, all low bytes, then all high
 *                            bytes; number of places; triangles of each; all their triangles, as
 *                            steps; two ends of each segment in which a pair meets, 16 bits a
 *                            coordinate. Of a frame of contours other numbers follow the
 *                            vertices: see page_add_trace
 *     data-frame="F"         the rest, as JSON
 *
 * A step is the difference from the number before, with its sign as its lowest bit. Numbers have
 * seven bits a byte, the low ones first. Blocks are packed by zlib and written in base 64.
 * Positions are so coarse for the view alone: the answer is that of the mesh as it was read.
 */
#ifndef TOOLS_PAGE_WRITE_H
#define TOOLS_PAGE_WRITE_H

#include "places.h"
#include "trace_report.h"

typedef struct page_file page_file;

/* A frame: what came of a pose. */
typedef struct page_frame {
    const char *name;
    const mesh_file *mesh;
    const mesh_check *check;
    const sc_pose *pose; /* positions without a stride */
    const place_list *places;
    uint32_t degenerate_faces;
    uint64_t pairs;
    double milliseconds;
    bool is_incomplete; /* there may be more pairs */
} page_frame;

/* A frame of contours: what came of the trace of a pose. */
typedef struct page_trace {
    const char *name;
    const mesh_file *mesh;
    const sc_pose *pose; /* positions without a stride */
    const trace_answer *answer;
    double milliseconds;
} page_trace;

/* Begins a page; NULL, and errno says why, if it cannot be. */
page_file *page_open(const char *path);

/* Adds a frame; false if there is no memory. */
bool page_add(page_file *page, const page_frame *frame);

/*
 * Adds a frame of contours; false if there is no memory. A page has frames of one kind.
 *
 * Behind the vertices its block has: the number of regions; of each 1 if it is the smaller side of
 * a contour, else 0; the region of each vertex, as steps; the number of contours that are drawn,
 * the longest first; of each twice its nodes, and 1 more if it is closed, then its four sides, each
 * as a step from that of the contour before; the nodes of all. A node is its edge + 1, as a step,
 * and then where on it, as a number up to 65535; or, of a vertex, 0 and its number, as a step.
 * Where the contour goes on, its two triangles follow, as steps from those before. The number of
 * regions stands for no region.
 */
bool page_add_trace(page_file *page, const page_trace *frame);

/* Ends the page and frees it. False if it could not be written to the end. A page without any frame
   is written, and says so. */
bool page_close(page_file *page);

#endif /* TOOLS_PAGE_WRITE_H */
