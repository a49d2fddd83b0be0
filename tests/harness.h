/*
 * A tiny test harness.
 *
 * Each tests/test_<module>.c is a program of its own:
 *
 *     static void pairs_of_two_triangles(void)
 *     {
 *         if (!CHECK(pointer != NULL)) return;
 *         CHECK_MSG(count == 3, "count is %u", count);
 *     }
 *
 *     SC_TEST_MAIN(SC_TEST(pairs_of_two_triangles), SC_TEST(another))
 *
 * Arguments: words that select the test functions whose names contain one of them; --seed N for the
 * random numbers; --scale P to run P percent of the random trials (default: SC_TEST_SCALE of the
 * environment, else 100, or 20 under sanitizers); --first to end at the first CHECK that fails;
 * --list.
 * The last line printed is "<program>: N passed, N failed, N skipped": functions that passed, those
 * that failed, and what test_skip left out. The exit status is 1 if one failed, 2 for wrong
 * arguments. A function without any CHECK fails; one that only skips neither passes nor fails.
 *
 * Not thread-safe: CHECK on the main thread only.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_HARNESS_H
#define SC_TESTS_HARNESS_H

#include <stddef.h>
#include <stdint.h>

typedef struct test_case {
    const char *name;
    void (*run)(void);
} test_case;

/* An entry of SC_TEST_MAIN. */
/* clang-format off */
#define SC_TEST(function) {#function, function}
/* clang-format on */

/* Defines main: runs the listed tests in order. */
#define SC_TEST_MAIN(...)                                                                          \
    int main(int argc, char **argv)                                                                \
    {                                                                                              \
        static const test_case test_cases[] = {__VA_ARGS__};                                       \
        return test_main(argc, argv, test_cases, sizeof(test_cases) / sizeof(test_cases[0]));      \
    }

int test_main(int argc, char **argv, const test_case *cases, size_t count);

#if defined(__GNUC__)
#    define SC_TEST_PRINTF(text, first) __attribute__((__format__(__printf__, text, first)))
#else
#    define SC_TEST_PRINTF(text, first)
#endif

/*
 * Both are expressions: 1 if cond holds, else 0 after recording the failure and printing it (the
 * first few of each test), with a printf-like explanation for CHECK_MSG.
 */
#define CHECK(cond)          test_check((cond) ? 1 : 0, __FILE__, __LINE__, #cond, " ")
#define CHECK_MSG(cond, ...) test_check((cond) ? 1 : 0, __FILE__, __LINE__, #cond, __VA_ARGS__)

int test_check(int ok, const char *file, int line, const char *condition, const char *format, ...)
    SC_TEST_PRINTF(5, 6);

/* Number of failed checks in the running test so far. */
uint64_t test_failures(void);

/* A note printed under the running test; no failure. Counts as a check. */
void test_note(const char *format, ...) SC_TEST_PRINTF(1, 2);

/* Says that the running test leaves something out, and why; counted in the last line. No check. */
void test_skip(const char *format, ...) SC_TEST_PRINTF(1, 2);

/*
 * Deterministic 64-bit random numbers (splitmix64). Each test function starts anew from the seed
 * and its own name, so a test selected by name alone draws the same numbers.
 */
uint64_t test_random(void);
uint32_t test_random_below(uint32_t bound);        /* 0 to bound - 1; bound > 0 */
uint32_t test_random_part(uint32_t mask);          /* some of these bits, or all */
double test_random_unit(void);                     /* [0, 1), 53 bits */
double test_random_range(double low, double high); /* uniform between */
uint64_t test_random_state(void);                  /* printed with a failure, goes back by ... */
void test_random_reset(uint64_t state);

/* count scaled by --scale, at least 1. */
uint32_t test_iterations(uint32_t count);

/* The same, but at least `least`: for tests that ask at the end whether they saw enough of what
   they are about, which a few trials may not have. */
uint32_t test_iterations_at_least(uint32_t count, uint32_t least);

/* Whether that leaves out nothing: shares and numbers of cases are asked for where there are cases
   enough. */
int test_is_full(void);

/* malloc that ends the program when there is no memory; free as usual. size 0 is allowed. */
void *test_allocate(size_t size);

#endif /* SC_TESTS_HARNESS_H */
