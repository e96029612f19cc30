/* The estimator as a model of fmi.c. */
typedef bte_state model;

static void model_step(model *s, double numbers[], bool first) {
    bte_real in[BTE_INPUTS], out[sizeof(bte_answers) / sizeof(bte_real)];
    bte_inputs x;
    for (unsigned i = 0; i < BTE_INPUTS; i++) {
        in[i] = (bte_real)numbers[i];
    }
    (void)memcpy(&x, in, sizeof x);
    if (first) {
        (void)bte_init(s, &{{ data }});
    } else {
        (void)bte_step(s, &x);
    }
    (void)memcpy(out, &s->answers, sizeof out);
    for (unsigned i = 0; i < sizeof out / sizeof *out; i++) {
        numbers[PAD_LEVEL + i] = (double)out[i];
    }
    numbers[REASON] = s->reason;
}

/* A state that comes from another process points into that one. */
static void model_moved(model *s) { s->car = &{{ data }}; }
