/* The estimator as a model of fmu.h. */
#include "bte.h"

typedef bte_state model;

static void tell(bte_real y[BTE_ANSWERS][BTE_BOUNDS], double told[]) {
    for (unsigned i = 0; i < FMU_TOLD; i++) {
        told[i] = (double)y[i / BTE_BOUNDS][i % BTE_BOUNDS];
    }
}

static int32_t model_start(model *s, const double given[], double told[]) {
    bte_real y[BTE_ANSWERS][BTE_BOUNDS];
    bte_init(s, &bte_this_car);
    bte_told(s, (bte_real)given[BTE_P_MC], y);
    tell(y, told);
    return (int32_t)BTE_NOT_BRAKED;
}

static int32_t model_step(model *s, const double given[], double told[]) {
    bte_real x[BTE_INPUTS], y[BTE_ANSWERS][BTE_BOUNDS];
    for (unsigned i = 0; i < BTE_INPUTS; i++) {
        x[i] = (bte_real)given[i];
    }
    const bte_reason reason = bte_step(s, x, y);
    tell(y, told);
    return (int32_t)reason;
}
