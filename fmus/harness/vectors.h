/* Vectors of four numbers, an extension of the C of GCC and Clang.  Who has another compiler computes the same bits, one
 * number after the other. */
#ifndef VECTORS_H
#define VECTORS_H

#if (defined(__GNUC__) || defined(__clang__)) && !defined(WITHOUT_VECTORS)
#define WITH_VECTORS
typedef double Four __attribute__((vector_size(32)));
typedef double FourInMemory __attribute__((vector_size(32), aligned(8), may_alias));
typedef long long Mask __attribute__((vector_size(32)));
#define SAME(a) ((Four){a, a, a, a})
#define FROM(address) (*(const FourInMemory *)(address))
#define TO(address) (*(FourInMemory *)(address))
#define PICK(mask, a, b) ((Four)(((mask) & (Mask)(a)) | (~(mask) & (Mask)(b))))
#define TRUTH(mask) ((Four)((mask) & (Mask)SAME(1.0)))
#define SIZE(a) ((Four)((Mask)(a) & ~(Mask)SAME(-0.0)))
#define SQRT(a) ((Four){sqrt((a)[0]), sqrt((a)[1]), sqrt((a)[2]), sqrt((a)[3])})
#endif

/* A function with vectors: the same bits with and without the wide registers of newer processors, which is chosen when
 * the library is loaded. */
#if defined(WITH_VECTORS) && !defined(WITHOUT_WIDE) && defined(__x86_64__) && defined(__GLIBC__) && !defined(__clang__)
#define WIDE __attribute__((target_clones("avx2", "default")))
#else
#define WIDE
#endif

#endif
