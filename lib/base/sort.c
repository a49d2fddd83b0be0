/*
 * Sorting. See sort.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/sort.h"

#include "base/jobs.h"

enum {
    INSERTION_MAX = 24,
    BYTE_VALUES = SC_SORT_PARTS,
    BYTE_MIN = 512, /* pairs, for which counting them pays */
    BYTES_MOST = 3, /* one in another; 4 KB of stack each */
    SAME_FEW = 4    /* with the same a, which are not worth passes by b */
};

void sc_sort_sift(sc_pair *heap, uint64_t count, uint64_t at)
{
    sc_pair moved = heap[at];
    for (;;) {
        uint64_t child = 2 * at + 1;
        if (child >= count) break;
        if (child + 1 < count && sc_sort_less(heap[child], heap[child + 1])) child++;
        if (!sc_sort_less(moved, heap[child])) break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = moved;
}

void sc_sort_heapify(sc_pair *pairs, uint64_t count)
{
    uint64_t at = count / 2;
    while (at > 0) sc_sort_sift(pairs, count, --at);
}

static void heapsort_pairs(sc_pair *pairs, uint64_t count)
{
    sc_sort_heapify(pairs, count);
    while (count > 1) {
        sc_pair last = pairs[--count];
        pairs[count] = pairs[0];
        pairs[0] = last;
        sc_sort_sift(pairs, count, 0);
    }
}

/* Gives up, and returns 0, once pairs have been moved by so many places in all. */
static int insertion_sort(sc_pair *pairs, uint64_t count, uint64_t most)
{
    uint64_t i, j;
    for (i = 1; i < count; i++) {
        sc_pair moved = pairs[i];
        for (j = i; j > 0 && sc_sort_less(moved, pairs[j - 1]); j--) pairs[j] = pairs[j - 1];
        pairs[j] = moved;
        if (most < i - j) return 0;
        most -= i - j;
    }
    return 1;
}

static sc_pair median(sc_pair x, sc_pair y, sc_pair z)
{
    if (sc_sort_less(y, x)) {
        sc_pair t = x;
        x = y;
        y = t;
    }
    if (sc_sort_less(z, x)) return x;
    return sc_sort_less(z, y) ? z : y;
}

/* Moves pairs so that [0, i) <= pivot <= [i, count), and returns i. The pivot is one of the
   pairs. */
static uint64_t split_at(sc_pair *pairs, uint64_t count, sc_pair pivot)
{
    uint64_t i = 0, j = count - 1;
    for (;;) { /* both ends stop at the pivot, so neither runs out of the array */
        sc_pair t;
        while (sc_sort_less(pairs[i], pivot)) i++;
        while (sc_sort_less(pivot, pairs[j])) j--;
        if (i >= j) return i;
        t = pairs[i];
        pairs[i++] = pairs[j];
        pairs[j--] = t;
    }
}

uint64_t sc_sort_split(sc_pair *pairs, uint64_t count)
{
    sc_pair some[9];
    uint64_t i;
    if (count < 9) return 0;
    for (i = 0; i < 9; i++) some[i] = pairs[i * (count / 9)];
    (void)insertion_sort(some, 9, UINT64_MAX);
    return split_at(pairs, count, some[4]);
}

static void quicksort(sc_pair *pairs, uint64_t count, int depth)
{
    while (count > INSERTION_MAX) {
        sc_pair pivot = median(pairs[0], pairs[count / 2], pairs[count - 1]);
        uint64_t i;
        if (depth-- == 0) {
            heapsort_pairs(pairs, count);
            return;
        }
        i = split_at(pairs, count, pivot);
        /* go on with the longer part, recurse into the shorter */
        if (i < count - i) {
            quicksort(pairs, i, depth);
            pairs += i;
            count -= i;
        } else {
            quicksort(pairs + i, count - i, depth);
            count = i;
        }
    }
    (void)insertion_sort(pairs, count, UINT64_MAX);
}

static void sort_by_comparing(sc_pair *pairs, uint64_t count)
{
    int depth = 2;
    uint64_t n;
    for (n = count; n > 1; n >>= 1) depth += 2;
    quicksort(pairs, count, depth);
}

static void sort_by_bytes(sc_pair *pairs, uint64_t count, int most);

/* most: how often by bytes yet. */
static void sort_some(sc_pair *pairs, uint64_t count, int most)
{
    if (count < BYTE_MIN || most == 0)
        sort_by_comparing(pairs, count);
    else
        sort_by_bytes(pairs, count, most - 1);
}

/* Orders pairs by the highest bits in which they differ, of which there are so many values, 256 at
   most: counts them, then exchanges each with the first that is not yet in order among those with
   its value, round by round. An exchange need not wait for the one before; to follow what was
   displaced from place to place takes three times as long. end: where those with each value end.
   Returns how many bits are below. */
static unsigned split_by_bits(sc_pair *pairs, uint64_t count, unsigned values,
                              uint64_t end[BYTE_VALUES])
{
    uint64_t next[BYTE_VALUES] = {0}, differ = 0, sum = 0, i;
    unsigned shift = 0, value;
    int left;
    for (i = 1; i < count; i++) differ |= sc_sort_number(pairs[i]) ^ sc_sort_number(pairs[0]);
    while (differ >> shift >= values) shift++;
    for (i = 0; i < count; i++) next[sc_sort_number(pairs[i]) >> shift & (values - 1)]++;
    for (value = 0; value < values; value++) {
        uint64_t some = next[value];
        next[value] = sum;
        end[value] = sum += some;
    }
    do {
        left = 0;
        for (value = 0; value < values; value++) {
            for (i = next[value]; i < end[value]; i++) {
                const sc_pair moved = pairs[i];
                const uint64_t to = next[sc_sort_number(moved) >> shift & (values - 1)]++;
                pairs[i] = pairs[to];
                pairs[to] = moved;
            }
            left |= next[value] < end[value];
        }
    } while (left);
    return shift;
}

static void sort_by_bytes(sc_pair *pairs, uint64_t count, int most)
{
    uint64_t end[BYTE_VALUES];
    const unsigned shift = split_by_bits(pairs, count, BYTE_VALUES, end);
    unsigned value;
    for (value = 0; value < BYTE_VALUES; value++) {
        uint64_t begin = value ? end[value - 1] : 0;
        if (shift > 0 && end[value] - begin > 1) sort_some(pairs + begin, end[value] - begin, most);
    }
}

void sc_sort_in_parts(sc_pair *pairs, uint64_t count, uint64_t end[SC_SORT_PARTS])
{
    (void)split_by_bits(pairs, count, SC_SORT_PARTS, end);
}

void sc_sort_pairs(sc_pair *pairs, uint64_t count)
{
    sort_some(pairs, count, BYTES_MOST);
}

enum { DIGIT_BITS = 10, DIGIT_VALUES = 1 << DIGIT_BITS, DIGIT_PAIRS_MIN = 5000 };

/* Sorts by the ten bits from shift on; pairs that have the same stay in order. */
typedef struct digit_sort {
    const sc_tasks *tasks;
    const sc_pair *from;
    sc_pair *to;
    unsigned shift;
    uint32_t *first; /* DIGIT_VALUES for each part: how many pairs have each; then where they go */
} digit_sort;

static uint64_t digit_of(const digit_sort *s, uint64_t i)
{
    return sc_sort_number(s->from[i]) >> s->shift & (DIGIT_VALUES - 1);
}

static void count_digits(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const digit_sort *s = (const digit_sort *)context;
    uint32_t *count = s->first + (size_t)part * DIGIT_VALUES, i;
    memset(count, 0, DIGIT_VALUES * sizeof *count);
    for (i = first; i < end; i++) count[digit_of(s, i)]++;
}

static void move_by_digit(void *context, uint32_t part, uint32_t first, uint32_t end)
{
    const digit_sort *s = (const digit_sort *)context;
    uint32_t *next = s->first + (size_t)part * DIGIT_VALUES, i;
    for (i = first; i < end; i++) s->to[next[digit_of(s, i)]++] = s->from[i];
}

static void pass_by_digit(digit_sort *s, uint32_t count)
{
    uint32_t parts = sc_jobs_loop(s->tasks, count, DIGIT_PAIRS_MIN, count_digits, s), part, digit,
             sum = 0;
    for (digit = 0; digit < DIGIT_VALUES; digit++)
        for (part = 0; part < parts; part++) {
            uint32_t *first = s->first + (size_t)part * DIGIT_VALUES + digit, some = *first;
            *first = sum;
            sum += some;
        }
    sc_jobs_loop(s->tasks, count, DIGIT_PAIRS_MIN, move_by_digit, s);
}

sc_pair *sc_sort_by_digits(sc_pair *pairs, sc_pair *spare, uint32_t count, unsigned bits,
                           const sc_tasks *tasks, uint32_t *room)
{
    uint32_t of_one[DIGIT_VALUES];
    digit_sort s;
    unsigned done;
    s.tasks = tasks;
    s.first = tasks ? room : of_one;
    for (done = 0; done < bits; done += DIGIT_BITS) {
        sc_pair *swapped = pairs;
        s.from = pairs;
        s.to = spare;
        s.shift = 32 + done;
        pass_by_digit(&s, count);
        pairs = spare;
        spare = swapped;
    }
    return pairs;
}

uint32_t sc_sort_digits_room(uint32_t count)
{
    uint32_t parts = (count - 1) / DIGIT_PAIRS_MIN + 1;
    return DIGIT_VALUES * (parts < SC_JOBS_PARTS ? parts : SC_JOBS_PARTS);
}

static unsigned bits_of(uint32_t number)
{
    unsigned bits = 0;
    while (bits < 32 && number >> bits) bits++;
    return bits;
}

/* A digit of the number of a pair, and where in the counts those of its values begin. */
typedef struct digit {
    unsigned shift, first;
    uint32_t last; /* its largest value */
} digit;

/* Bits of a digit where all are counted at once: ten, or eight where that would be more than four
   digits. So there are at most eight digits, with 4096 values: 16 KB of stack. */
enum { COUNTED_MOST = 8, COUNTED_VALUES = 4 << DIGIT_BITS };

/* The digits for some bits from lowest on, as equal as can be, none wider than most, behind those
   that are there; returns how many there are then. */
static unsigned choose_digits(unsigned bits, unsigned lowest, unsigned most, digit *digits,
                              unsigned count)
{
    unsigned some = (bits + most - 1) / most;
    for (; some > 0; some--, count++) {
        const unsigned width = (bits + some - 1) / some;
        digits[count].shift = lowest;
        digits[count].last = (1u << width) - 1u;
        digits[count].first = count ? digits[count - 1].first + digits[count - 1].last + 1 : 0;
        lowest += width;
        bits -= width;
    }
    return count;
}

/* Sorts by so many of the lowest bits of b, then of a: counts all digits at once, then moves pairs
   by one after the other. Returns where the sorted ones are. */
static sc_pair *sort_by_both(sc_pair *from, sc_pair *to, uint64_t count, unsigned bits_a,
                             unsigned bits_b)
{
    const unsigned most = bits_a > 2 * DIGIT_BITS || bits_b > 2 * DIGIT_BITS ? 8 : DIGIT_BITS;
    uint32_t next[COUNTED_VALUES];
    digit digits[COUNTED_MOST];
    unsigned some = choose_digits(bits_b, 0, most, digits, 0), d;
    uint64_t i;
    some = choose_digits(bits_a, 32, most, digits, some);
    memset(next, 0, (digits[some - 1].first + digits[some - 1].last + 1) * sizeof *next);
    for (i = 0; i < count; i++) {
        const uint64_t number = sc_sort_number(from[i]);
        for (d = 0; d < some; d++)
            next[digits[d].first + (number >> digits[d].shift & digits[d].last)]++;
    }
    for (d = 0; d < some; d++) {
        const unsigned shift = digits[d].shift;
        const uint32_t last = digits[d].last;
        uint32_t *at = next + digits[d].first, sum = 0, value;
        sc_pair *swapped = from;
        for (value = 0; value <= last; value++) {
            const uint32_t same = at[value];
            at[value] = sum;
            sum += same;
        }
        for (i = 0; i < count; i++) to[at[sc_sort_number(from[i]) >> shift & last]++] = from[i];
        from = to;
        to = swapped;
    }
    return from;
}

void sc_sort_with_room(sc_pair *pairs, sc_pair *spare, uint64_t count)
{
    uint64_t i, differ = 0;
    unsigned bits_a, bits_b;
    sc_pair *sorted;
    if (count < BYTE_MIN) {
        sc_sort_pairs(pairs, count);
        return;
    }
    for (i = 1; i < count; i++) differ |= sc_sort_number(pairs[i]) ^ sc_sort_number(pairs[0]);
    if (!differ) return;
    bits_a = bits_of((uint32_t)(differ >> 32));
    bits_b = bits_of((uint32_t)differ);
    if (count >> bits_a >= SAME_FEW) {
        sorted = sort_by_both(pairs, spare, count, bits_a, bits_b);
        if (sorted != pairs) memcpy(pairs, sorted, (size_t)count * sizeof *pairs);
        return;
    }
    /* few have the same a: what is left is near its place */
    sorted = sc_sort_by_digits(pairs, spare, (uint32_t)count, bits_a, NULL, NULL);
    if (sorted != pairs) memcpy(pairs, sorted, (size_t)count * sizeof *pairs);
    if (!insertion_sort(pairs, count, 4 * count)) sc_sort_pairs(pairs, count);
}

/* More are split first, so that what is sorted with room is in the cache: into parts of about so
   many, as smaller ones take longer. */
enum { CACHED_MAX = 1 << 16, CACHED = 1 << 12 };

static void sort_in_some(sc_pair *pairs, sc_pair *spare, uint64_t room, uint64_t count, int most)
{
    uint64_t end[BYTE_VALUES], begin = 0;
    unsigned values = 2, value;
    if (count <= room && count <= CACHED_MAX) {
        sc_sort_with_room(pairs, spare, count);
        return;
    }
    if (most == 0 || room < CACHED) {
        sc_sort_pairs(pairs, count);
        return;
    }
    while (values < BYTE_VALUES && count / values > CACHED) values *= 2;
    if (split_by_bits(pairs, count, values, end) == 0) return;
    for (value = 0; value < values; begin = end[value++])
        sort_in_some(pairs + begin, spare, room, end[value] - begin, most - 1);
}

void sc_sort_in_room(sc_pair *pairs, sc_pair *spare, uint64_t room, uint64_t count)
{
    sort_in_some(pairs, spare, room, count, BYTES_MOST);
}
