/*
 * Instruction sets (ISA) that some inner loops are compiled for, and the best one at run time.
 *
 * SPDX-License-Identifier: MIT
 *
 * Such a loop is written once, in a file named ..._kernel.h, over sixteen floats at a time
 * (simd/lanes.h), and included by a .c file for each instruction set. All give the same answers.
 */
#ifndef SC_SIMD_ISA_H
#define SC_SIMD_ISA_H

#include <stddef.h>

#include "base/assume.h"

/* SC_NO_SIMD leaves the plain form alone, for other machines and to compare. SIMD: single
   instruction, multiple data; SSE and AVX: x86's streaming and advanced vector extensions. */
#if !defined(SC_NO_SIMD) && defined(__GNUC__) && defined(__x86_64__)
#  define SC_ISA_X86 1
#else
#  define SC_ISA_X86 0
#endif

/* gcc's and clang's vector types, of which they make what the machine has; on 32-bit x86 only with
   SSE2. SC_NO_VECTORS leaves them alone, too. */
#if !defined(SC_NO_VECTORS) && defined(__GNUC__) && (!defined(__i386__) || defined(__SSE2__))
#  define SC_ISA_VECTORS 1
#else
#  define SC_ISA_VECTORS 0
#endif

/* Before a loop of a few rounds, over axes or corners, of which the compiler is to make straight
   code. */
#if defined(__clang__)
#  define SC_UNROLL _Pragma("unroll")
#elif defined(__GNUC__)
#  define SC_UNROLL _Pragma("GCC unroll 8")
#else
#  define SC_UNROLL
#endif

/* Of functions that are to be compiled anew for each constant they are called with. Without
   optimization that gains nothing, takes more stack, and makes steps of a debugger and counts of
   coverage harder to read. */
#if defined(__GNUC__) && defined(__OPTIMIZE__)
#  define SC_INLINE inline __attribute__((always_inline))
#else
#  define SC_INLINE inline
#endif

/* Of functions that are rarely called, to leave the registers of their callers alone. */
#if defined(__GNUC__)
#  define SC_NOINLINE __attribute__((noinline))
#else
#  define SC_NOINLINE
#endif

/* The number itself, to be computed alone: compilers like to compute several addresses in one
   vector register, from which it takes longer to get them. */
static inline size_t sc_alone(size_t number)
{
#if defined(__GNUC__)
    __asm__("" : "+r"(number));
#endif
    return number;
}

/* As SC_SIMD_... in starcontour.h, best last. */
typedef enum sc_isa { SC_ISA_BASE = 1, SC_ISA_AVX2 = 2, SC_ISA_AVX512 = 3 } sc_isa;

/* The best that this machine has. */
static inline sc_isa sc_isa_best(void)
{
#if SC_ISA_X86
    if (SC_HARDLY(!__builtin_cpu_supports("avx2"))) return SC_ISA_BASE;
    return SC_HARDLY(!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512bw") ||
                     !__builtin_cpu_supports("avx512dq") || !__builtin_cpu_supports("avx512vl"))
               ? SC_ISA_AVX2
               : SC_ISA_AVX512;
#else
    return SC_ISA_BASE;
#endif
}

#endif
