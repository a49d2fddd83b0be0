/*
 * Sorting and memory: on orders that are hard on a quicksort, and on requests that no memory can
 * meet; and bits of masks.
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/bits.h"
#include "base/memory.h"
#include "base/sort.h"
#include "harness.h"

/* The address sanitizer ends the program where malloc would return NULL. */
#if defined(__SANITIZE_ADDRESS__)
#  define HAS_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#  if __has_feature(address_sanitizer) || __has_feature(memory_sanitizer)
#    define HAS_ADDRESS_SANITIZER 1
#  endif
#endif

static int compare(const void *x, const void *y)
{
    const sc_pair *p = (const sc_pair *)x, *q = (const sc_pair *)y;
    if (p->a != q->a) return p->a < q->a ? -1 : 1;
    return p->b < q->b ? -1 : p->b > q->b;
}

enum { SHAPES = 9 };

/* Number i of count in one of SHAPES orders. */
static sc_pair element(uint32_t shape, uint32_t i, uint32_t count)
{
    sc_pair pair = {0, 0};
    switch (shape) {
    case 0:
        pair.a = test_random_below(0xffffffff);
        break;
    case 1:
        pair.a = i;
        break;
    case 2:
        pair.a = count - i;
        break;
    case 3: /* up and down */
        pair.a = i < count / 2 ? i : count - i;
        break;
    case 4: /* the ends and the middle are among the least: bad pivots each time */
        pair.a = i % 2 == 0 ? i / 2 : i < count / 2 ? count - i : i;
        break;
    case 8: /* most differ in b alone, and three in a byte of their own */
        if (i > 0 && i < 4) pair.a = 0xffu << 8 * i;
        pair.b = test_random_below(0xffffffff);
        return pair;
    case 5: /* few values */
        pair.a = test_random_below(3);
        break;
    default: /* all the same */
        break;
    }
    pair.b =
        shape == 6 ? 7 : test_random_below(shape == 7 ? 4096 : 4); /* 7: differ in twelve bits */
    return pair;
}

static void sorting(void)
{
    for (uint32_t count = 0; count < 100000; count = count < 70 ? count + 1 : count * 3 / 2) {
        sc_pair *pairs = (sc_pair *)test_allocate(count * sizeof(sc_pair));
        sc_pair *right = (sc_pair *)test_allocate(count * sizeof(sc_pair));
        sc_pair *other = (sc_pair *)test_allocate(count * sizeof(sc_pair));
        sc_pair *spare = (sc_pair *)test_allocate(count * sizeof(sc_pair));
        for (uint32_t shape = 0; shape < SHAPES; ++shape) {
            for (uint32_t i = 0; i < count; ++i)
                right[i] = pairs[i] = other[i] = element(shape, i, count);
            qsort(right, count, sizeof(sc_pair), compare);
            sc_sort_pairs(pairs, count);
            sc_sort_with_room(other, spare, count);
            CHECK_MSG(count == 0 || memcmp(pairs, right, count * sizeof(sc_pair)) == 0,
                      "%" PRIu32 " pairs in order %" PRIu32, count, shape);
            CHECK_MSG(count == 0 || memcmp(other, right, count * sizeof(sc_pair)) == 0,
                      "%" PRIu32 " pairs in order %" PRIu32 ", with room", count, shape);
        }
        free(pairs);
        free(right);
        free(other);
        free(spare);
    }
}

/* Room for 16384 pairs is the least that is of use. Of the last order each split takes away one of
   the few that have a high bit of their own, so that what is left has to be sorted without room. */
static void sorting_in_room(void)
{
    static const uint32_t counts[] = {100, 16384, 16385, 40000, 65536, 65537, 100000};
    static const uint32_t rooms[] = {1, 16383, 16384, 100000};
    enum { COUNTS = sizeof counts / sizeof counts[0], ROOMS = sizeof rooms / sizeof rooms[0] };
    sc_pair *pairs = (sc_pair *)test_allocate(100000 * sizeof(sc_pair));
    sc_pair *right = (sc_pair *)test_allocate(100000 * sizeof(sc_pair));
    for (uint32_t n = 0; n < COUNTS * ROOMS; ++n) {
        const uint32_t count = counts[n % COUNTS], room = rooms[n / COUNTS];
        sc_pair *spare = (sc_pair *)test_allocate(room * sizeof(sc_pair)); /* not one more */
        for (uint32_t shape = 0; shape <= SHAPES; ++shape) {
            for (uint32_t i = 0; i < count; ++i) {
                right[i] = element(shape < SHAPES ? shape : 8, i, count);
                if (shape == SHAPES) right[i].a = i % 97 || i >= 97 * 32 ? 0 : 1u << i / 97;
            }
            memcpy(pairs, right, count * sizeof(sc_pair));
            qsort(right, count, sizeof(sc_pair), compare);
            sc_sort_in_room(pairs, spare, room, count);
            CHECK_MSG(memcmp(pairs, right, count * sizeof(sc_pair)) == 0,
                      "%" PRIu32 " pairs in order %" PRIu32 ", room for %" PRIu32, count, shape,
                      room);
        }
        free(spare);
    }
    free(pairs);
    free(right);
}

/* What is said of sc_sort_split. */
static void splitting(void)
{
    for (uint32_t count = 0; count < 400; ++count)
        for (uint32_t shape = 0; shape < SHAPES; ++shape) {
            sc_pair pairs[400], right[400];
            uint64_t at;
            for (uint32_t i = 0; i < count; ++i) right[i] = pairs[i] = element(shape, i, count);
            at = sc_sort_split(pairs, count);
            CHECK(count < 9 ? at == 0 : at < count);
            qsort(right, count, sizeof(sc_pair), compare);
            qsort(pairs, at, sizeof(sc_pair), compare);
            qsort(pairs + at, count - at, sizeof(sc_pair), compare);
            CHECK(count == 0 || memcmp(pairs, right, count * sizeof(sc_pair)) == 0);
        }
}

/* The greatest first, again and again. */
static void heaps(void)
{
    for (uint32_t count = 1; count < 80; ++count)
        for (uint32_t shape = 0; shape < SHAPES; ++shape) {
            sc_pair heap[80], right[80];
            for (uint32_t i = 0; i < count; ++i) right[i] = heap[i] = element(shape, i, count);
            qsort(right, count, sizeof(sc_pair), compare);
            sc_sort_heapify(heap, count);
            for (uint32_t left = count; left > 0; --left) {
                CHECK_MSG(compare(&heap[0], &right[left - 1]) == 0,
                          "%" PRIu32 " of %" PRIu32 " in order %" PRIu32, left, count, shape);
                heap[0] = heap[left - 1];
                if (left > 1) sc_sort_sift(heap, left - 1, 0);
            }
        }
}

static void keys_of_floats(void)
{
    static const float ascending[] = {-3e38f, -1.5f, -1e-40f, -0.0f, 0.0f,
                                      1e-45f, 1.0f,  2.0f,    3e38f};
    for (size_t i = 1; i < sizeof(ascending) / sizeof(ascending[0]); ++i)
        CHECK(sc_sort_key(ascending[i - 1]) < sc_sort_key(ascending[i]));
}

static void alignment(void)
{
    sc_allocator standard = sc_memory_allocator(NULL);
    for (uint32_t i = 0; i < 200; ++i) {
        uint64_t size = 1 + test_random_below(500), step = UINT64_C(1) << test_random_below(7);
        unsigned char *memory = (unsigned char *)standard.allocate(standard.user, size, step);
        if (!CHECK(memory != NULL)) return;
        CHECK((uintptr_t)memory % step == 0);
        memset(memory, 0xa5, size);
        standard.release(standard.user, memory, size);
    }
}

/* Of what no memory can hold, the size overflows, or malloc refuses it. */
static void more_than_there_is(void)
{
    sc_allocator standard = sc_memory_allocator(NULL);
    sc_scratch scratch;
    sc_list list = {NULL, 0, 0};
    CHECK(standard.allocate(standard.user, UINT64_MAX, SC_ALIGNMENT) == NULL);
    sc_scratch_init(&scratch, &standard);
    CHECK(sc_scratch_take(&scratch, UINT64_MAX, 8) == NULL);
    CHECK(sc_scratch_take(&scratch, UINT64_MAX / 8, 8) == NULL);
    CHECK(sc_scratch_take_filled(&scratch, UINT64_MAX / 8, 16, 0) == NULL);
    CHECK(!sc_list_reserve(&scratch, &list, UINT64_MAX / 4));
    CHECK(list.items == NULL && scratch.blocks == NULL);
#if !defined(HAS_ADDRESS_SANITIZER) && PTRDIFF_MAX > INT32_MAX /* two gigabytes there may be */
    CHECK(standard.allocate(standard.user, PTRDIFF_MAX - 4096, SC_ALIGNMENT) == NULL);
#endif
    sc_scratch_clear(&scratch);
}

/* Blocks go back in any order, and all at once. */
static void scratch_memory(void)
{
    sc_allocator standard = sc_memory_allocator(NULL);
    sc_scratch scratch;
    void *block[6];
    sc_scratch_init(&scratch, &standard);
    for (uint32_t i = 0; i < 6; ++i) {
        block[i] = sc_scratch_take_filled(&scratch, i, 3, 0x11);
        CHECK(block[i] != NULL && (uintptr_t)block[i] % SC_ALIGNMENT == 0);
    }
    sc_scratch_give(&scratch, block[5]); /* the last, one between, the first */
    sc_scratch_give(&scratch, block[2]);
    sc_scratch_give(&scratch, block[0]);
    sc_scratch_give(&scratch, NULL);
    CHECK(((const unsigned char *)block[4])[11] == 0x11);
    CHECK(scratch.blocks != NULL);
    sc_scratch_clear(&scratch);
    CHECK(scratch.blocks == NULL);
}

/* Against a look at bit after bit, of all masks of sixteen lanes and of some longer ones. */
static void bits_of_masks(void)
{
    for (uint32_t i = 0; i < 0x20000; ++i) {
        uint32_t low = i < 0x10000 ? i : test_random_below(0xffffffff), set = 0, lowest = 0;
        uint64_t high = (uint64_t)test_random_below(0xffffffff) << 32;
        for (uint32_t bit = 32; bit-- > 0;) {
            set += low >> bit & 1u;
            if (low >> bit & 1u) lowest = bit;
        }
        CHECK(sc_bits_count(low) == set);
        if (!low) continue;
        CHECK(sc_bits_lowest(low) == lowest && sc_bits_lowest64(high | low) == lowest &&
              sc_bits_lowest64((uint64_t)low << 32) == lowest + 32);
    }
}

SC_TEST_MAIN(SC_TEST(sorting), SC_TEST(sorting_in_room), SC_TEST(splitting), SC_TEST(heaps),
             SC_TEST(keys_of_floats), SC_TEST(alignment), SC_TEST(more_than_there_is),
             SC_TEST(scratch_memory), SC_TEST(bits_of_masks))
