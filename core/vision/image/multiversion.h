// SPDX-License-Identifier: Apache-2.0
#pragma once

// Function multiversioning: a marked function is compiled for several instruction sets, and the loader selects the
// widest that the processor supports. Functions that it calls must be inlined (FLOORLOC_INLINE) to be compiled the same
// way. Sanitizers do not work with the loader's resolvers, so their builds use the portable code.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define FLOORLOC_WIDE_VECTORS __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define FLOORLOC_WIDE_VECTORS
#endif

#define FLOORLOC_INLINE [[gnu::always_inline]] inline
