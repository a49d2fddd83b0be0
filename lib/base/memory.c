/*
 * Memory through the caller's allocator. See memory.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

#include "base/jobs.h"

/* Stands before each scratch allocation and fills one alignment unit. */
struct sc_scratch_block {
    sc_scratch_block *previous, *next;
    uint64_t bytes; /* with this header */
};

/* malloc knows no alignment in C99: the pointer it gave stands just before the aligned memory. */
static void *default_allocate(void *user, uint64_t size, uint64_t alignment)
{
    unsigned char *raw, *aligned;
    (void)user;
    if (size > SIZE_MAX - alignment - sizeof(void *)) return NULL;
    raw = (unsigned char *)malloc((size_t)size + (size_t)alignment + sizeof(void *));
    if (!raw) return NULL;
    aligned = raw + sizeof(void *);
    aligned += (alignment - ((uintptr_t)aligned & (alignment - 1))) & (alignment - 1);
    memcpy(aligned - sizeof(void *), &raw, sizeof(void *));
    return aligned;
}

static void default_release(void *user, void *memory, uint64_t size)
{
    void *raw;
    (void)user;
    (void)size;
    memcpy(&raw, (unsigned char *)memory - sizeof(void *), sizeof(void *));
    free(raw);
}

sc_allocator sc_memory_allocator(const sc_allocator *caller)
{
    sc_allocator standard;
    if (caller) return *caller;
    standard.allocate = default_allocate;
    standard.release = default_release;
    standard.user = NULL;
    return standard;
}

void sc_scratch_init(sc_scratch *scratch, const sc_allocator *allocator)
{
    scratch->allocator = *allocator;
    scratch->blocks = NULL;
    scratch->live_bytes = scratch->peak_bytes = scratch->allocations = 0;
    scratch->tasks = NULL;
}

void *sc_scratch_allocate(sc_scratch *scratch, uint64_t bytes)
{
    void *memory = scratch->allocator.allocate(scratch->allocator.user, bytes, SC_ALIGNMENT);
    if (!memory) return NULL;
    scratch->allocations++;
    scratch->live_bytes += bytes;
    if (scratch->live_bytes > scratch->peak_bytes) scratch->peak_bytes = scratch->live_bytes;
    return memory;
}

void *sc_scratch_take(sc_scratch *scratch, uint64_t count, size_t size)
{
    sc_scratch_block *block;
    uint64_t bytes;
    if (count > (SIZE_MAX - SC_ALIGNMENT) / size) return NULL;
    bytes = count * size + SC_ALIGNMENT;
    block = (sc_scratch_block *)sc_scratch_allocate(scratch, bytes);
    if (!block) return NULL;
    block->bytes = bytes;
    block->previous = NULL;
    block->next = scratch->blocks;
    if (block->next) block->next->previous = block;
    scratch->blocks = block;
    return (unsigned char *)block + SC_ALIGNMENT;
}

/* Memory is filled by several threads in pieces, where there are some: the system clears pages when
   they are first written to. */
enum { PIECE_BYTES = 1 << 16, PIECES_A_PART = 8 };

typedef struct filling {
    unsigned char *memory;
    uint64_t bytes;
    int byte;
} filling;

static void fill_pieces(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const filling *f = (const filling *)context;
    uint64_t from = (uint64_t)first * PIECE_BYTES, to = (uint64_t)end * PIECE_BYTES;
    (void)part;
    if (to > f->bytes) to = f->bytes;
    memset(f->memory + from, f->byte, (size_t)(to - from));
}

void *sc_scratch_take_filled(sc_scratch *scratch, uint64_t count, size_t size, int byte)
{
    filling f;
    f.memory = (unsigned char *)sc_scratch_take(scratch, count, size);
    f.bytes = count * size;
    f.byte = byte;
    if (f.memory && f.bytes)
        (void)sc_jobs_loop(scratch->tasks, (uint32_t)((f.bytes - 1) / PIECE_BYTES + 1),
                           PIECES_A_PART, fill_pieces, &f);
    return f.memory;
}

void sc_scratch_give(sc_scratch *scratch, void *memory)
{
    sc_scratch_block *block;
    if (!memory) return;
    block = (sc_scratch_block *)(void *)((unsigned char *)memory - SC_ALIGNMENT);
    if (block->previous)
        block->previous->next = block->next;
    else
        scratch->blocks = block->next;
    if (block->next) block->next->previous = block->previous;
    scratch->live_bytes -= block->bytes;
    scratch->allocator.release(scratch->allocator.user, block, block->bytes);
}

void sc_scratch_clear(sc_scratch *scratch)
{
    while (scratch->blocks)
        sc_scratch_give(scratch, (unsigned char *)scratch->blocks + SC_ALIGNMENT);
}

int sc_list_grow(sc_scratch *scratch, sc_list *list, uint64_t more)
{
    uint64_t capacity = 2 * list->capacity;
    uint32_t *items;
    if (capacity < list->count + more) capacity = list->count + more;
    if (capacity < 256) capacity = 256;
    items = (uint32_t *)sc_scratch_take(scratch, capacity, sizeof *items);
    if (!items) return 0;
    if (list->count) memcpy(items, list->items, (size_t)list->count * sizeof *items);
    sc_scratch_give(scratch, list->items);
    list->items = items;
    list->capacity = capacity;
    return 1;
}
