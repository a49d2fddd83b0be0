/*
 * Memory through the caller's allocator, and scratch memory for building.
 *
 * SPDX-License-Identifier: MIT
 *
 * An sc_scratch is a list of allocations. Each can be given back at any time and all go at once
 * with sc_scratch_clear, so that an early return after a failed step leaks nothing. The thread that
 * called the library takes and gives, no other. Not for queries, which allocate nothing.
 */
#ifndef SC_BASE_MEMORY_H
#define SC_BASE_MEMORY_H

#include <stddef.h>
#include "starcontour.h"

typedef struct sc_scratch_block sc_scratch_block;

typedef struct sc_scratch {
    sc_allocator allocator;
    sc_scratch_block *blocks;
    uint64_t live_bytes, peak_bytes, allocations; /* of these and of sc_scratch_allocate */
    const sc_tasks *tasks; /* the host's threads for loops over the memory; NULL: there is one */
} sc_scratch;

/* The caller's allocator, or malloc and free if there is none. */
sc_allocator sc_memory_allocator(const sc_allocator *caller);

void sc_scratch_init(sc_scratch *scratch, const sc_allocator *allocator);

/* Memory that is not the scratch's and outlives it, aligned to SC_ALIGNMENT: only counted with it.
   NULL if there is none. */
void *sc_scratch_allocate(sc_scratch *scratch, uint64_t bytes);

/* count elements of size bytes, aligned to SC_ALIGNMENT and not cleared; NULL if that overflows or
   the allocator fails. A count of 0 gives a valid pointer to nothing. */
void *sc_scratch_take(sc_scratch *scratch, uint64_t count, size_t size);

/* The same, filled with a byte. */
void *sc_scratch_take_filled(sc_scratch *scratch, uint64_t count, size_t size, int byte);

/* Gives back what sc_scratch_take returned; NULL is allowed. */
void sc_scratch_give(sc_scratch *scratch, void *memory);

void sc_scratch_clear(sc_scratch *scratch);

/*
 * A growing array of uint32_t in scratch memory. Zeroed, it is empty. Its memory is given back with
 * sc_scratch_give(scratch, list.items).
 */
typedef struct sc_list {
    uint32_t *items;
    uint64_t count, capacity;
} sc_list;

/* Makes the array larger, for more further items; 0 if memory ran out. */
int sc_list_grow(sc_scratch *scratch, sc_list *list, uint64_t more);

/* Makes room for more further items, where there is none; 0 if memory ran out. */
static inline int sc_list_reserve(sc_scratch *scratch, sc_list *list, uint64_t more)
{
    return list->count + more <= list->capacity || sc_list_grow(scratch, list, more);
}

/* Appends one item for which there is room. */
static inline void sc_list_add(sc_list *list, uint32_t item)
{
    list->items[list->count++] = item;
}

#endif
