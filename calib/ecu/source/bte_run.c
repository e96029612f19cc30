/* Runs the estimator of brake-cal over many samples: in a test, on a host, on the target.
 *
 * With BTE_VECTORS defined it is a program that compares with vectors.h, which Python wrote.
 */
#include "bte_run.h"

bte_sample bte_sample_of(const bte_real x[BTE_INPUTS]) {
    const bte_sample sample = {x[0], x[1], {x[2], x[3], x[4], x[5]}, x[6], x[7], {x[8], x[9]}};
    return sample;
}

void bte_run(const bte_real *samples, uint32_t count, bte_real *out) {
    static bte_state state;
    bte_init(&state, &bte_this_car);
    for (uint32_t i = 0; i < count; i++) {
        bte_real *y = &out[i * BTE_OUTPUTS];
        const bte_sample sample = bte_sample_of(&samples[i * BTE_INPUTS]);
        bte_output told;
        bte_step(&state, &sample, &told);
        y[0] = (bte_real)told.reason;
        for (uint32_t b = 0; b < BTE_BOUNDS; b++) {
            y[1U + b] = told.level[b];
            y[4U + b] = told.ratio[b];
            y[7U + b] = told.pad_friction[BTE_FRONT][b];
            y[10U + b] = told.pad_friction[BTE_REAR][b];
            y[13U + b] = told.brake_torque[BTE_FRONT][b];
            y[16U + b] = told.brake_torque[BTE_REAR][b];
            y[19U + b] = told.brake_torque_sum[b];
        }
    }
}

#ifdef BTE_VECTORS
#include <stdio.h>

#include "vectors.h" /* COUNT, EVERY, TOLERANCE, inputs, expected */

int main(void) {
    static bte_real told[COUNT * BTE_OUTPUTS];
    uint32_t other = 0, wrong = 0;
    bte_real worst = (bte_real)0.0;
    bte_run(inputs, COUNT, told);
    for (uint32_t block = 0; block < COUNT / EVERY; block++) {
        const bte_real *found = &told[((block + 1U) * EVERY - 1U) * BTE_OUTPUTS];
        const bte_real *right = &expected[block * BTE_OUTPUTS];
        other += found[0] > right[0] || found[0] < right[0];
        for (uint32_t i = 1; i < BTE_OUTPUTS; i++) {
            const bte_real least = right[i] < (bte_real)1e-6 ? (bte_real)1e-6 : right[i];
            const bte_real off = found[i] - right[i], apart = off < (bte_real)0.0 ? -off : off;
            worst = apart / least > worst ? apart / least : worst;
            wrong += !(apart <= (bte_real)TOLERANCE * least);
        }
    }
    printf("%u samples: largest difference %.3g, %u beyond %g, %u reasons differ\n",
           (unsigned)COUNT, (double)worst, (unsigned)wrong, TOLERANCE, (unsigned)other);
    return other > 0U || wrong > 0U;
}
#endif
