/*
 * Writes pages; see page_write.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "page_write.h"

#include "page_bytes.h"
#include "query_checks.h"
#include "query_text.h"
#include "tool_json.h"

#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum {
    PLACES_LISTED = 200,     /* in the list at the side; all are coloured */
    SEGMENTS_SHOWN = 100000, /* of a frame */
    NODES_SHOWN = 500000     /* of a frame's contours, or all of the longest */
};

struct page_file {
    FILE *file;
    uint32_t frame_count, mesh_count;
    uint32_t *indices; /* of the last mesh */
    uint32_t vertex_count, triangle_count;
};

/* Bytes that grow; failed once there was no memory. */
typedef struct bytes {
    uint8_t *data;
    size_t size, capacity;
    bool failed;
} bytes;

/* Makes room for more bytes and returns where they go, or NULL. */
static uint8_t *append(bytes *to, size_t size)
{
    if (to->failed) return NULL;
    if (size > to->capacity - to->size) {
        const size_t capacity = 2 * to->capacity + size;
        uint8_t *data = (uint8_t *)realloc(to->data, capacity);
        if (!data) {
            to->failed = true;
            return NULL;
        }
        to->data = data;
        to->capacity = capacity;
    }
    to->size += size;
    return to->data + to->size - size;
}

static void put_number(bytes *to, uint64_t value)
{
    do {
        uint8_t *out = append(to, 1);
        if (!out) return;
        *out = (uint8_t)((value & 127) | (value > 127 ? 128 : 0));
        value >>= 7;
    } while (value);
}

static void put_step(bytes *to, uint32_t *last, uint32_t value)
{
    const bool down = value < *last;
    const uint64_t length = down ? *last - value : value - *last;
    put_number(to, down ? 2 * length - 1 : 2 * length);
    *last = value;
}

/* In base 64 (RFC 4648). */
static void write_base64(FILE *file, const uint8_t *data, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char line[4096];
    size_t length = 0;
    for (size_t i = 0; i < size; i += 3) {
        const size_t left = size - i;
        const uint32_t bits = (uint32_t)data[i] << 16 |
                              (uint32_t)(left > 1 ? data[i + 1] : 0) << 8 |
                              (uint32_t)(left > 2 ? data[i + 2] : 0);
        line[length++] = digits[bits >> 18];
        line[length++] = digits[bits >> 12 & 63];
        line[length++] = '=';
        line[length++] = '=';
        if (left > 1) line[length - 2] = digits[bits >> 6 & 63];
        if (left > 2) line[length - 1] = digits[bits & 63];
        if (length < sizeof line) continue;
        fwrite(line, 1, length, file);
        length = 0;
    }
    fwrite(line, 1, length, file);
}

/* Writes a block and frees its bytes; false if there was no memory for them. */
static bool write_block(FILE *file, const char *kind, uint32_t number, bytes *block)
{
    uLongf size = compressBound((uLong)block->size);
    uint8_t *packed = block->failed ? NULL : (uint8_t *)malloc(size);
    const bool done =
        packed && compress2(packed, &size, block->data, (uLong)block->size, 6) == Z_OK;
    if (done) {
        fprintf(file, "<script type=\"text/plain\" data-block=\"%s-%lu\">", kind,
                (unsigned long)number);
        write_base64(file, packed, size);
        fputs("</script>\n", file);
    }
    free(packed);
    free(block->data);
    return done;
}

/* ------------------------------------------------------------------------------------------------
 * A mesh and its frames
 */

/* Writes the triangles of a mesh, unless they are those of the frame before. */
static bool add_mesh(page_file *page, const mesh_file *mesh)
{
    const size_t count = 3 * (size_t)mesh->triangle_count;
    if (page->mesh_count > 0 && mesh->vertex_count == page->vertex_count &&
        mesh->triangle_count == page->triangle_count &&
        memcmp(page->indices, mesh->indices, count * sizeof *mesh->indices) == 0)
        return true;
    uint32_t *indices = (uint32_t *)realloc(page->indices, count * sizeof *indices + 1);
    if (!indices) return false;
    page->indices = indices;
    memcpy(indices, mesh->indices, count * sizeof *indices);
    page->vertex_count = mesh->vertex_count;
    page->triangle_count = mesh->triangle_count;
    bytes block = {NULL, 0, 0, false};
    uint32_t last = 0;
    put_number(&block, count);
    for (size_t i = 0; i < count; i++) put_step(&block, &last, indices[i]);
    return write_block(page->file, "mesh", page->mesh_count++, &block);
}

/* A coordinate in sixteen bits of its box. */
static uint16_t quantized(double x, double low, double high)
{
    const double part = (x - low) / (high - low);
    if (!(part > 0)) return 0;
    return (uint16_t)(part < 1 ? 65535 * part + 0.5 : 65535);
}

/* The box round all positions. */
static void find_box(const sc_pose *pose, double low[3], double high[3])
{
    for (int k = 0; k < 3; k++) low[k] = high[k] = 0;
    for (size_t v = 0; v < pose->vertex_count; v++) {
        double at[3];
        mesh_file_position(pose->positions, pose->position_type, v, at);
        for (int k = 0; k < 3; k++) {
            if (v == 0 || at[k] < low[k]) low[k] = at[k];
            if (v == 0 || at[k] > high[k]) high[k] = at[k];
        }
    }
}

static void put_positions(bytes *to, const sc_pose *pose, const double low[3], const double high[3])
{
    const size_t count = pose->vertex_count;
    uint8_t *out = append(to, 6 * count);
    uint16_t last[3] = {0, 0, 0};
    if (!out) return;
    for (size_t v = 0; v < count; v++) {
        double at[3];
        mesh_file_position(pose->positions, pose->position_type, v, at);
        for (size_t k = 0; k < 3; k++) {
            const uint16_t value = quantized(at[k], low[k], high[k]);
            /* the shorter way round, below 32768 either way */
            const uint16_t up = (uint16_t)(value - last[k]), down = (uint16_t)(last[k] - value);
            const uint16_t step = up < 0x8000 ? (uint16_t)(2 * up) : (uint16_t)(2 * (down - 1) + 1);
            out[2 * k * count + v] = (uint8_t)step;
            out[(2 * k + 1) * count + v] = (uint8_t)(step >> 8);
            last[k] = value;
        }
    }
}

static void put_places(bytes *to, const place_list *places)
{
    uint32_t last = 0;
    put_number(to, places->count);
    for (uint32_t i = 0; i < places->count; i++) put_number(to, places->places[i].triangle_count);
    for (uint32_t i = 0; i < places->count; i++) {
        const place *one = &places->places[i];
        for (size_t j = 0; j < one->triangle_count; j++)
            put_step(to, &last, places->triangles[one->begin + j]);
    }
}

static void put_segments(bytes *to, const place_list *places, uint32_t count, const double low[3],
                         const double high[3])
{
    uint8_t *out = append(to, 12 * (size_t)count);
    for (size_t i = 0; out && i < 6 * (size_t)count; i++) {
        const size_t k = i % 3;
        const uint16_t value = quantized(places->segments[i / 6][i / 3 % 2][k], low[k], high[k]);
        *out++ = (uint8_t)value;
        *out++ = (uint8_t)(value >> 8);
    }
}

/* What frames of both kinds have. */
static cJSON *describe_mesh(const page_file *page, const char *name, const mesh_file *mesh,
                            const double low[3], const double high[3])
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "number", page->frame_count);
    cJSON_AddNumberToObject(object, "mesh", page->mesh_count - 1);
    cJSON_AddStringToObject(object, "name", name);
    cJSON_AddNumberToObject(object, "vertices", mesh->vertex_count);
    cJSON_AddNumberToObject(object, "triangles", mesh->triangle_count);
    cJSON_AddItemToObject(object, "low", cJSON_CreateDoubleArray(low, 3));
    cJSON_AddItemToObject(object, "high", cJSON_CreateDoubleArray(high, 3));
    return object;
}

static cJSON *describe(const page_file *page, const page_frame *frame, uint32_t segments,
                       const double low[3], const double high[3])
{
    const mesh_check *check = frame->check;
    cJSON *object = describe_mesh(page, frame->name, frame->mesh, low, high);
    cJSON_AddNumberToObject(object, "pairs", (double)frame->pairs);
    cJSON_AddBoolToObject(object, "incomplete", frame->is_incomplete);
    cJSON_AddNumberToObject(object, "ms", query_text_rounded(frame->milliseconds));
    cJSON_AddNumberToObject(object, "segments", segments);
    cJSON_AddNumberToObject(object, "parts", check->part_count);
    cJSON_AddNumberToObject(object, "closed_parts", check->closed_parts);
    query_checks_add_defects(object, check, frame->degenerate_faces);
    cJSON_AddNumberToObject(object, "place_count", frame->places->count);
    cJSON_AddItemToObject(
        object, "places",
        query_checks_places(frame->places, check, frame->mesh, PLACES_LISTED, false));
    return object;
}

/* ------------------------------------------------------------------------------------------------
 * Contours
 */

/* How many of the longest are drawn. */
static uint64_t count_drawn(const trace_answer *answer)
{
    uint64_t count = 0, nodes = 0;
    while (count < answer->contour_count) {
        nodes += answer->contours[count].contour.count;
        if (count > 0 && nodes > NODES_SHOWN) break;
        count++;
    }
    return count;
}

/* A number for a region, or for none. */
static uint32_t region_or_none(const trace_answer *answer, uint32_t region)
{
    return region < answer->region_count ? region : (uint32_t)answer->region_count;
}

/* The smaller side of a contour on a sheet; SC_TRACE_NO_EDGE if there is none. */
static uint32_t smaller_side(const trace_answer *answer, const trace_listed *one, uint32_t sheet)
{
    const uint32_t side = sc_region_hint(answer->regions, &one->sides, sheet);
    return side < 2 ? one->sides.sides[sheet][side] : SC_TRACE_NO_EDGE;
}

/* Whether each region is the smaller side of a contour, and the regions of vertices. Returns how
   many are such a side. */
static uint64_t put_regions(bytes *to, const trace_answer *answer, uint32_t vertex_count)
{
    put_number(to, answer->region_count);
    uint8_t *is_smaller = append(to, (size_t)answer->region_count);
    uint64_t count = 0;
    if (!is_smaller) return 0;
    memset(is_smaller, 0, (size_t)answer->region_count);
    for (uint64_t i = 0; i < answer->contour_count; i++) {
        for (uint32_t sheet = 0; sheet < 2; sheet++) {
            const uint32_t region = smaller_side(answer, &answer->contours[i], sheet);
            if (region >= answer->region_count || is_smaller[region]) continue;
            is_smaller[region] = 1;
            count++;
        }
    }
    uint32_t last = 0;
    for (uint32_t v = 0; v < vertex_count; v++)
        put_step(to, &last, region_or_none(answer, answer->vertex_regions[v]));
    return count;
}

static void put_contours(bytes *to, const trace_answer *answer, uint64_t count)
{
    uint32_t last[4] = {0, 0, 0, 0}, edge = 0, vertex = 0, sheets[2] = {0, 0};
    put_number(to, count);
    for (uint64_t i = 0; i < count; i++) {
        const trace_listed *one = &answer->contours[i];
        put_number(to, 2 * one->contour.count + (one->contour.begin == SC_TRACE_CLOSED));
        for (int k = 0; k < 4; k++)
            put_step(to, &last[k], region_or_none(answer, one->sides.sides[k / 2][k % 2]));
    }
    for (uint64_t i = 0; i < count; i++) {
        const sc_trace_contour *one = &answer->contours[i].contour;
        for (uint64_t k = 0; k < one->count; k++) {
            const sc_trace_node *node = &answer->nodes[one->first + k];
            const bool is_vertex = node->edge == SC_TRACE_NO_EDGE;
            put_step(to, &edge, is_vertex ? 0 : node->edge + 1);
            if (is_vertex)
                put_step(to, &vertex, node->triangle);
            else
                put_number(to, quantized(node->along, 0, 1));
            if (one->begin != SC_TRACE_CLOSED && k + 1 == one->count) continue;
            for (int s = 0; s < 2; s++) put_step(to, &sheets[s], node->sheets[s]);
        }
    }
}

/* A contour for the list: how long it is and where, and the areas of the smaller sides. */
static cJSON *describe_contour(const trace_answer *answer, const trace_listed *one)
{
    const sc_trace_contour *contour = &one->contour;
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (uint64_t i = 0; i < contour->count; i++) {
        const double *point = answer->nodes[contour->first + i].point;
        for (int k = 0; k < 3; k++) {
            if (i == 0 || point[k] < low[k]) low[k] = point[k];
            if (i == 0 || point[k] > high[k]) high[k] = point[k];
        }
    }
    for (int k = 0; k < 3; k++) {
        const double half = high[k] / 2 - low[k] / 2;
        low[k] += half;
        high[k] = 2 * half;
    }
    cJSON *object = cJSON_CreateObject();
    cJSON_AddNumberToObject(object, "length", contour->length);
    cJSON_AddNumberToObject(object, "nodes", (double)contour->count);
    cJSON_AddStringToObject(object, "begin", tool_choice_name(trace_ends, contour->begin));
    cJSON_AddStringToObject(object, "end", tool_choice_name(trace_ends, contour->end));
    cJSON_AddBoolToObject(object, "one_sheet", (contour->flags & SC_TRACE_ONE_SHEET) != 0);
    cJSON_AddItemToObject(object, "center", cJSON_CreateDoubleArray(low, 3));
    cJSON_AddItemToObject(object, "size", cJSON_CreateDoubleArray(high, 3));
    cJSON *areas = cJSON_AddArrayToObject(object, "areas");
    for (uint32_t sheet = 0; sheet < 2; sheet++) {
        const uint32_t region = smaller_side(answer, one, sheet);
        if (region < answer->region_count)
            cJSON_AddItemToArray(areas, cJSON_CreateNumber(answer->regions[region].area));
    }
    return object;
}

static cJSON *describe_trace(const page_file *page, const page_trace *frame, uint64_t drawn,
                             uint64_t smaller, const double low[3], const double high[3])
{
    const trace_answer *answer = frame->answer;
    cJSON *object = describe_mesh(page, frame->name, frame->mesh, low, high);
    cJSON_AddNumberToObject(object, "ms", query_text_rounded(frame->milliseconds));
    cJSON_AddNumberToObject(object, "length", trace_report_length(answer));
    cJSON_AddNumberToObject(object, "closed", (double)trace_report_closed(answer));
    cJSON_AddNumberToObject(object, "regions", (double)answer->region_count);
    cJSON_AddNumberToObject(object, "smaller", (double)smaller);
    cJSON_AddNumberToObject(object, "drawn", (double)drawn);
    cJSON_AddNumberToObject(object, "place_count", (double)answer->contour_count);
    cJSON *contours = cJSON_AddArrayToObject(object, "places");
    for (uint64_t i = 0; i < answer->contour_count && i < PLACES_LISTED; i++)
        cJSON_AddItemToArray(contours, describe_contour(answer, &answer->contours[i]));
    return object;
}

/* ------------------------------------------------------------------------------------------------
 * The page
 */

/* Where the data go: at a line that marks it. */
static size_t find_mark(void)
{
    static const char mark[] = "\n<!-- DATA -->\n";
    for (size_t i = 0; i + sizeof mark <= page_bytes_size; i++) {
        if (memcmp(page_bytes + i, mark, sizeof mark - 1) == 0) return i + 1;
    }
    return page_bytes_size;
}

page_file *page_open(const char *path)
{
    page_file *page = (page_file *)calloc(1, sizeof *page);
    if (page) page->file = fopen(path, "wb");
    if (!page || !page->file) {
        free(page);
        return NULL;
    }
    fwrite(page_bytes, 1, find_mark(), page->file);
    return page;
}

/* Writes the rest of a frame, which is then counted, and frees it. */
static bool write_description(page_file *page, cJSON *object)
{
    fprintf(page->file, "<script type=\"application/json\" data-frame=\"%lu\">",
            (unsigned long)page->frame_count);
    const bool written = tool_json_write(object, page->file);
    fputs("</script>\n", page->file);
    page->frame_count++;
    return written;
}

bool page_add(page_file *page, const page_frame *frame)
{
    double low[3], high[3];
    bytes block = {NULL, 0, 0, false};
    const place_list *places = frame->places;
    const uint32_t segments =
        places->segment_count < SEGMENTS_SHOWN ? places->segment_count : SEGMENTS_SHOWN;
    if (!add_mesh(page, frame->mesh)) return false;
    find_box(frame->pose, low, high);
    put_positions(&block, frame->pose, low, high);
    put_places(&block, places);
    put_segments(&block, places, segments, low, high);
    if (!write_block(page->file, "frame", page->frame_count, &block)) return false;
    return write_description(page, describe(page, frame, segments, low, high));
}

bool page_add_trace(page_file *page, const page_trace *frame)
{
    double low[3], high[3];
    bytes block = {NULL, 0, 0, false};
    const uint64_t drawn = count_drawn(frame->answer);
    if (!add_mesh(page, frame->mesh)) return false;
    find_box(frame->pose, low, high);
    put_positions(&block, frame->pose, low, high);
    const uint64_t smaller = put_regions(&block, frame->answer, frame->mesh->vertex_count);
    put_contours(&block, frame->answer, drawn);
    if (!write_block(page->file, "frame", page->frame_count, &block)) return false;
    return write_description(page, describe_trace(page, frame, drawn, smaller, low, high));
}

bool page_close(page_file *page)
{
    const size_t mark = find_mark();
    fwrite(page_bytes + mark, 1, page_bytes_size - mark, page->file);
    const bool written = !ferror(page->file);
    const bool closed = fclose(page->file) == 0;
    free(page->indices);
    free(page);
    return written && closed;
}
