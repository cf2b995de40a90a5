/* XXH3, 128 bits, with the instructions of AVX2, which the processor must have. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* digest: the low 64 bits, then the high ones */
void hapgrid_digest_avx2(const void* bytes, size_t size, uint64_t digest[2]);

#ifdef __cplusplus
}
#endif
