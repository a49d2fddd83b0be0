/*
 * Memory through the caller's allocator. See memory.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

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

void *sc_scratch_take_filled(sc_scratch *scratch, uint64_t count, size_t size, int byte)
{
    void *memory = sc_scratch_take(scratch, count, size);
    if (memory) memset(memory, byte, (size_t)(count * size));
    return memory;
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
