// What loops over arrays need to become vector instructions.

#ifndef DEFORMABLE_VECTOR_LOOPS_H
#define DEFORMABLE_VECTOR_LOOPS_H

// A second version of a loop for processors with 256-bit vectors; the loader of the plugin chooses.
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && __GNUC__ >= 12
#define DEFORMABLE_CLONES __attribute__((target_clones("arch=x86-64-v3", "default")))
#else
#define DEFORMABLE_CLONES
#endif

// The arrays of a loop do not overlap.
#if defined(__clang__)
#define DEFORMABLE_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#else
#define DEFORMABLE_INDEPENDENT _Pragma("GCC ivdep")
#endif

#endif
