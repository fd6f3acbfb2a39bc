// SPDX-License-Identifier: Apache-2.0
#pragma once

// One source, several instruction sets: a function marked with this is compiled for each, and the loader picks the
// widest that the processor has. What it calls must be inlined (FLOORLOC_INLINE) to be compiled the same way.
// Sanitizers run before the loader's resolvers may, so their builds take the portable path.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define FLOORLOC_WIDE_VECTORS __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define FLOORLOC_WIDE_VECTORS
#endif

#define FLOORLOC_INLINE [[gnu::always_inline]] inline
