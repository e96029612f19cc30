/* libFuzzer over the estimator: a stop with faults put in at any sample. No answer may be other
 * than finite, no bounds out of order, no reason unknown; a state that lasted must resume.
 *
 *     clang -g -O1 -fsanitize=fuzzer,address,undefined -I. bte.c bte_car_NAME.c fuzz.c -lm
 *
 * The input: five bytes for each fault: when, which input, how, how much, how long.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bte_vectors.h"

enum { FAULT = 5, HOWS = 8 };

static bte_real spoilt(bte_real x, unsigned how, unsigned much, bte_real first) {
    const bte_real size = (bte_real)(1 << (much & 15U)) / (bte_real)256 * ((much & 16U) ? -1 : 1);
    switch (how % HOWS) {
    case 0: return x + size;
    case 1: return x * size;
    case 2: return (bte_real)NAN;
    case 3: return (much & 1U) ? (bte_real)INFINITY : -(bte_real)INFINITY;
    case 4: return first;
    case 5: return size * (bte_real)1e6;
    case 6: return x * ((bte_real)1 + (bte_real)(much & 31U) / (bte_real)64);
    default: return (much & 1U) ? (bte_real)1e-40 : (bte_real)1e30;
    }
}

static void check(const bte_state *s, bte_reason reason) {
    const bte_interval *y = (const bte_interval *)&s->answers;
    for (size_t i = 0; i < sizeof s->answers / sizeof *y; i++) {
        if (!(isfinite(y[i].lower) && isfinite(y[i].median) && isfinite(y[i].upper)
              && y[i].lower <= y[i].median && y[i].median <= y[i].upper) || reason > BTE_ABS) {
            fprintf(stderr, "answer %zu: %g %g %g, reason %d\n", i, (double)y[i].lower,
                    (double)y[i].median, (double)y[i].upper, (int)reason);
            abort();
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static bte_state s;
    if (bte_init(&s, BTE_VECTORS_CAR) != BTE_READY) { abort(); }
    for (uint32_t k = 0; k < BTE_VECTORS_COUNT; k++) {
        bte_inputs in = bte_vectors_inputs[k];
        bte_real *x = (bte_real *)&in;
        for (size_t f = 0; f + FAULT <= size; f += FAULT) {
            const uint8_t *fault = data + f;
            const uint32_t begin = fault[0] * BTE_VECTORS_COUNT / 256U;
            const uint32_t lasts = 1U + fault[4] * fault[4] / 64U;
            const unsigned what = fault[1] % 13U; /* an input, a reset, all wheels alike */
            if (k >= begin && k < begin + lasts) {
                if (what == 12U) {
                    for (unsigned i = 2; i < 6; i++) {
                        x[i] = spoilt(x[i], fault[2], fault[3], x[i]);
                    }
                } else if (what == 11U && k == begin) {
                    bte_exchange(&s, BTE_VECTORS_CAR);
                    if (!bte_resume(&s, BTE_VECTORS_CAR)) { abort(); }
                } else if (what < 11U) {
                    const bte_real *first = (const bte_real *)&bte_vectors_inputs[begin];
                    x[what] = spoilt(x[what], fault[2], fault[3], first[what]);
                }
            }
        }
        check(&s, bte_step(&s, &in));
    }
    return 0;
}
