/* The estimator as a model of fmi.c. */
typedef bte_state model;

static void model_step(model *s, double numbers[], bool first) {
    bte_real x[BTE_INPUTS], y[BTE_ANSWERS][BTE_BOUNDS];
    for (unsigned i = 0; i < BTE_INPUTS; i++) {
        x[i] = (bte_real)numbers[i];
    }
    if (first) {
        bte_init(s, &bte_this_car);
        bte_told(s, x[BTE_P_MC], y);
    }
    numbers[REASON] = first ? BTE_NOT_BRAKED : bte_step(s, x, y);
    for (unsigned i = 0; i < BTE_ANSWERS * BTE_BOUNDS; i++) {
        numbers[LEVEL + i] = (double)y[i / BTE_BOUNDS][i % BTE_BOUNDS];
    }
}
