/* Runs the estimator of brake-cal, in a test. */
#ifndef BTE_RUN_H
#define BTE_RUN_H

#include "bte.h"

#ifdef __cplusplus
extern "C" {
#endif

/* p_mc, a_x, four wheel speeds, steering, driven, drive; reason, then seven answers with their bounds. */
enum { BTE_INPUTS = 10, BTE_OUTPUTS = 22 };

/* A row of inputs as the estimator takes it. */
bte_sample bte_sample_of(const bte_real x[BTE_INPUTS]);

/* Run `count` rows of inputs from the start into rows of outputs. */
void bte_run(const bte_real *samples, uint32_t count, bte_real *out);

#ifdef __cplusplus
}
#endif

#endif
