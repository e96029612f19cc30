/* Runs the estimator of brake-cal over many samples. With BTE_VECTORS defined it is a program that
 * compares with bte_vectors.h, which Python wrote.
 */
#include <string.h>

#include "bte.h"

enum { BTE_TOLD = 1 + BTE_ANSWERS * BTE_BOUNDS }; /* a row: the reason, then the answers */

/* Run `count` rows of inputs from the start into rows of answers. */
void bte_run(const bte_real *samples, uint32_t count, bte_real *told) {
    static bte_state state;
    bte_init(&state, &bte_this_car);
    for (uint32_t i = 0; i < count; i++) {
        bte_real y[BTE_ANSWERS][BTE_BOUNDS];
        told[i * BTE_TOLD] = (bte_real)bte_step(&state, &samples[i * BTE_INPUTS], y);
        (void)memcpy(&told[i * BTE_TOLD + 1U], y, sizeof y);
    }
}

#ifdef BTE_VECTORS
#include <math.h>
#include <stdio.h>

#include "bte_vectors.h" /* COUNT, EVERY, TOLERANCE, inputs, expected */

int main(void) {
    static bte_real told[COUNT * BTE_TOLD];
    unsigned wrong = 0U;
    double worst = 0.0;
    bte_run(&inputs[0][0], COUNT, told);
    for (uint32_t i = 0; i < COUNT / EVERY * BTE_TOLD; i++) {
        const uint32_t end = (i / BTE_TOLD + 1U) * EVERY - 1U;
        const double right = (double)expected[i / BTE_TOLD][i % BTE_TOLD];
        const double found = (double)told[end * BTE_TOLD + i % BTE_TOLD];
        const double apart = fabs(found - right) / fmax(right, 1e-6); /* of reasons 0.1 or more */
        wrong += !(apart <= TOLERANCE);
        worst = fmax(worst, apart);
    }
    printf("%u samples: largest difference %.3g, %u beyond %g\n", COUNT, worst, wrong, TOLERANCE);
    return wrong > 0U;
}
#endif
