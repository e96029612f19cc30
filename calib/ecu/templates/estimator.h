/* The estimator as a model of fmi.c. */
typedef bte_state model;

static void model_step(model *s, double numbers[], bool first) {
    bte_inputs x;
    bte_real *inputs = (bte_real *)&x;
    const bte_real *answers = (const bte_real *)&s->answers;
    for (unsigned i = 0; i < BTE_INPUTS; i++) {
        inputs[i] = (bte_real)numbers[i];
    }
    if (first) {
        (void)bte_init(s, &{{ data }});
    } else {
        s->car = &{{ data }}; /* a state that comes from another process points into that one */
        (void)bte_step(s, &x);
    }
    for (unsigned i = 0; i < sizeof s->answers / sizeof *answers; i++) {
        numbers[PAD_LEVEL + i] = (double)answers[i];
    }
    numbers[REASON] = s->reason;
}
