/*
 * The test harness: see harness.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "harness.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#    define TEST_DEFAULT_SCALE 20
#elif defined(__has_feature)
#    if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#        define TEST_DEFAULT_SCALE 20
#    endif
#endif
#ifndef TEST_DEFAULT_SCALE
#    define TEST_DEFAULT_SCALE 100
#endif

enum { TEST_SHOWN_FAILURES = 10 };

static const char *running_name;
static uint64_t running_checks, running_failures, running_skips;
static uint64_t seed = 1, random_state;
static uint32_t scale = TEST_DEFAULT_SCALE;
static int ends_at_failure; /* the program does, at the first check that fails */

static void print_failed(void)
{
    printf("FAILED %s: %" PRIu64 " of %" PRIu64 " checks\n", running_name, running_failures,
           running_checks);
    fflush(stdout);
}

int test_check(int ok, const char *file, int line, const char *condition, const char *format, ...)
{
    ++running_checks;
    if (ok) return 1;
    if (++running_failures <= TEST_SHOWN_FAILURES) {
        va_list arguments;
        printf("%s:%d: in %s: CHECK(%s) failed. ", file, line, running_name, condition);
        va_start(arguments, format);
        vprintf(format, arguments);
        va_end(arguments);
        printf("\n    (--seed %" PRIu64 " --scale %" PRIu32 ", random state %" PRIu64 ")\n", seed,
               scale, random_state);
        fflush(stdout);
    }
    if (ends_at_failure) {
        print_failed();
        exit(1);
    }
    return 0;
}

uint64_t test_failures(void)
{
    return running_failures;
}

void test_note(const char *format, ...)
{
    va_list arguments;
    ++running_checks;
    printf("    %s: ", running_name);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}

void test_skip(const char *format, ...)
{
    va_list arguments;
    ++running_skips;
    printf("skipped: %s: ", running_name);
    va_start(arguments, format);
    vprintf(format, arguments);
    va_end(arguments);
    printf("\n");
}

uint64_t test_random(void)
{
    uint64_t z = random_state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

uint32_t test_random_below(uint32_t bound)
{
    return (uint32_t)(((test_random() >> 32) * bound) >> 32);
}

uint32_t test_random_part(uint32_t mask)
{
    uint32_t some = mask & (uint32_t)test_random();
    return some ? some : mask;
}

double test_random_unit(void)
{
    return (double)(test_random() >> 11) * 0x1p-53;
}

double test_random_range(double low, double high)
{
    return low + (high - low) * test_random_unit();
}

uint64_t test_random_state(void)
{
    return random_state;
}

void test_random_reset(uint64_t state)
{
    random_state = state;
}

uint32_t test_iterations(uint32_t count)
{
    uint64_t scaled = (uint64_t)count * scale / 100;
    return scaled == 0 ? 1 : (uint32_t)scaled;
}

uint32_t test_iterations_at_least(uint32_t count, uint32_t least)
{
    uint32_t scaled = test_iterations(count);
    return scaled < least ? least : scaled;
}

int test_is_full(void)
{
    return test_iterations(100) >= 100;
}

void *test_allocate(size_t size)
{
    void *memory = malloc(size == 0 ? 1 : size);
    if (memory == NULL) {
        fprintf(stderr, "out of memory\n");
        exit(2);
    }
    return memory;
}

/* The state a test starts from: the seed stirred with the bytes of its name. */
static uint64_t state_of(const char *name)
{
    random_state = seed;
    for (; *name != '\0'; ++name) {
        random_state ^= (unsigned char)*name;
        random_state = test_random();
    }
    return random_state;
}

static int read_number(const char *text, uint64_t *number)
{
    char *end;
    unsigned long long value = strtoull(text, &end, 0);
    if (*text == '\0' || *end != '\0') return 0;
    *number = value;
    return 1;
}

static int is_selected(const char *name, int argc, char **argv)
{
    int words = 0;
    for (int i = 1; i < argc; ++i) {
        if (argv[i] == NULL) continue;
        words = 1;
        if (strstr(name, argv[i]) != NULL) return 1;
    }
    return !words;
}

int test_main(int argc, char **argv, const test_case *cases, size_t count)
{
    const char *slash = strrchr(argv[0], '/');
    const char *program = slash != NULL ? slash + 1 : argv[0];
    const char *environment = getenv("SC_TEST_SCALE");
    uint64_t number;
    unsigned passed = 0, failed = 0, run = 0;
    uint64_t skipped = 0;

    if (environment != NULL && read_number(environment, &number)) scale = (uint32_t)number;
    for (int i = 1; i < argc; ++i) {
        if (strcmp(argv[i], "--list") == 0) {
            for (size_t k = 0; k < count; ++k) printf("%s\n", cases[k].name);
            return 0;
        }
        if (strcmp(argv[i], "--first") == 0) {
            ends_at_failure = 1;
            argv[i] = NULL;
            continue;
        }
        if (strcmp(argv[i], "--seed") != 0 && strcmp(argv[i], "--scale") != 0) {
            if (argv[i][0] != '-') continue;
            fprintf(stderr, "usage: %s [--seed N] [--scale PERCENT] [--first] [--list] [NAME...]\n",
                    program);
            return 2;
        }
        if (i + 1 >= argc || !read_number(argv[i + 1], &number)) {
            fprintf(stderr, "%s: %s needs a number\n", program, argv[i]);
            return 2;
        }
        if (strcmp(argv[i], "--seed") == 0) {
            seed = number;
        } else {
            scale = (uint32_t)number;
        }
        argv[i] = NULL;
        argv[++i] = NULL;
    }

    for (size_t k = 0; k < count; ++k) {
        if (!is_selected(cases[k].name, argc, argv)) continue;
        running_name = cases[k].name;
        running_checks = running_failures = running_skips = 0;
        random_state = state_of(running_name);
        cases[k].run();
        ++run;
        skipped += running_skips;
        if (running_checks == 0 && running_skips == 0) {
            printf("%s: no check was made\n", running_name);
            running_failures = 1;
        }
        if (running_failures != 0) {
            print_failed();
            ++failed;
        } else if (running_checks != 0) {
            ++passed;
        }
        fflush(stdout);
    }
    if (run == 0) {
        fprintf(stderr, "%s: no such test\n", program);
        return 2;
    }
    printf("%s: %u passed, %u failed, %" PRIu64 " skipped\n", program, passed, failed, skipped);
    return failed != 0;
}
